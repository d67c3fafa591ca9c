/* SPDX-License-Identifier: Apache-2.0 */
/* A shared object that is no HDAPI library: it has the first function and lacks the others. */
unsigned hdInitDevice(const char* name) {
    (void)name;
    return 0;
}
