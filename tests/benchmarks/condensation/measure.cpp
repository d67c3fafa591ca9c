// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/measure.hpp"

#include <chrono>
#include <exception>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

rusage usage_of_this_process() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage;
}

double cpu_seconds(const rusage& usage) {
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void write_all(int file, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t written = write(file, text.data() + done, text.size() - done);
        if (written <= 0) _exit(1);
        done += static_cast<std::size_t>(written);
    }
}

std::string read_all(int file) {
    std::string text;
    char buffer[4096];
    for (ssize_t count = 0; (count = read(file, buffer, sizeof buffer)) > 0;)
        text.append(buffer, static_cast<std::size_t>(count));
    return text;
}

[[noreturn]] void run_and_exit(const std::function<Json()>& work, int file) {
    try {
        write_all(file, work().dump());
        _exit(0);
    } catch (const std::exception& error) {
        write_all(file, error.what());
        _exit(1);
    }
}

}  // namespace

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Cost cost_of(const std::function<void()>& work) {
    const rusage before = usage_of_this_process();
    const double begin = now_seconds();
    work();
    const double seconds = now_seconds() - begin;
    const rusage after = usage_of_this_process();
    // Linux reports KiB.
    return {seconds, cpu_seconds(after) - cpu_seconds(before),
            1024 * (std::int64_t{after.ru_maxrss} - std::int64_t{before.ru_maxrss})};
}

Json to_json(const Cost& cost) {
    return {{"seconds", cost.seconds}, {"cpu_seconds", cost.cpu_seconds}, {"peak_bytes", cost.peak_bytes}};
}

Json in_child(const std::function<Json()>& work) {
    int ends[2];
    if (pipe(ends) != 0) throw SystemFailure({"pipe", "cannot be opened", "", ""});
    const pid_t child = fork();
    if (child < 0) throw SystemFailure({"fork", "failed", "", "leave more memory free"});
    if (child == 0) {
        close(ends[0]);
        run_and_exit(work, ends[1]);
    }
    close(ends[1]);
    const std::string text = read_all(ends[0]);
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status))
        throw SystemFailure({"measuring process", "killed by signal " + std::to_string(WTERMSIG(status)), "",
                             "leave more memory free"});
    if (WEXITSTATUS(status) != 0) throw SystemFailure({"measuring process", text, "", ""});
    return Json::parse(text);
}

}  // namespace palpate
