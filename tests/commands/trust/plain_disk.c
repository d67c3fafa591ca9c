// SPDX-License-Identifier: Apache-2.0
// Preloaded, it makes every file system one that has no files without names and, where NO_LOCKS is set, no locks either,
// as some network file systems are.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

static int refuse(int error) {
    errno = error;
    return -1;
}

int open(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, int) : 0;
    va_end(rest);
    if ((flags & O_TMPFILE) == O_TMPFILE) return refuse(EOPNOTSUPP);
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int fcntl(int file, int command, ...) {
    va_list rest;
    va_start(rest, command);
    const long argument = va_arg(rest, long);
    va_end(rest);
    if (getenv("NO_LOCKS") && (command == F_OFD_SETLK || command == F_OFD_SETLKW || command == F_OFD_GETLK)) return refuse(ENOLCK);
    return (int)syscall(SYS_fcntl, file, command, argument);
}

int flock(int file, int operation) {
    if (getenv("NO_LOCKS")) return refuse(ENOLCK);
    return (int)syscall(SYS_flock, file, operation);
}
