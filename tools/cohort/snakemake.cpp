// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/snakemake.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"

namespace palpate::cohort {
namespace {

// Memory that a job may have without swapping, MB (proc(5), MemAvailable).
int available_memory_mb() {
    std::ifstream meminfo("/proc/meminfo");
    std::string key;
    for (double kibibytes = 0; meminfo >> key >> kibibytes; meminfo.ignore(64, '\n'))
        if (key == "MemAvailable:") return static_cast<int>(kibibytes * 1024 / 1e6);
    return 4000;
}

std::filesystem::path profile_folder(const SnakemakeRun& run) {
    for (const std::filesystem::path& folder :
         {run.pipelines / "profiles" / run.profile, std::filesystem::absolute(run.profile)})
        if (std::filesystem::exists(folder / "config.yaml")) return folder;
    throw InvalidInput({"--profile " + run.profile,
                        "is neither a profile of Palpate nor a folder with config.yaml",
                        "local, slurm or a folder", ""});
}

// The kernel ends Snakemake when this process is killed; its jobs in a cluster go on by themselves.
std::vector<std::string> command_of(const SnakemakeRun& run, const CohortFolder& folder) {
    std::vector<std::string> command{"setpriv", "--pdeathsig", "TERM", "snakemake"};
    const auto add = [&](const std::string& option, const std::string& value) {
        command.push_back(option);
        command.push_back(value);
    };
    add("--snakefile", (run.pipelines / "Snakefile").string());
    add("--profile", profile_folder(run).string());
    add("--directory", folder.batch().string());
    add("--configfile", folder.plan().string());
    add("--log-handler-script", (run.pipelines / "log_handler.py").string());
    command.emplace_back("--nolock");  // ours is freed by the system, however this process ends
    if (run.profile == "local") {
        add("--cores", std::to_string(run.cores));
        add("--resources", fmt::format("mem_mb={}", available_memory_mb()));
    }
    return command;
}

struct Running {
    pid_t pid = 0;
    int output = -1;  // what its log handler prints
};

// In a process group of its own, so that an interrupt reaches its jobs once.
Running start(const std::vector<std::string>& command, const std::filesystem::path& log) {
    std::vector<char*> argv;
    for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
        throw SystemFailure({"snakemake", std::generic_category().message(errno), "", ""});
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addopen(&actions, 2, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    // Python would leave what it compiled of the log handler in the installation, if it may write there.
    setenv("PYTHONDONTWRITEBYTECODE", "1", 0);
    Running running{0, ends[0]};
    const int error = posix_spawnp(&running.pid, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error != 0)
        throw SystemFailure({"snakemake", "cannot be started: " + std::generic_category().message(error), "",
                             "install the package util-linux"});
    return running;
}

// Turns the lines of pipelines/log_handler.py into events.
class EventReader {
  public:
    explicit EventReader(const std::function<void(const JobEvent&)>& on_event) : on_event_(on_event) {}

    void read(std::string_view bytes) {
        buffer_ += bytes;
        for (std::size_t end = 0; (end = buffer_.find('\n')) != std::string::npos; buffer_.erase(0, end + 1))
            read_line(buffer_.substr(0, end));
    }
    bool any() const { return !jobs_.empty(); }

  private:
    void read_line(const std::string& line) {
        const auto json = nlohmann::json::parse(line, nullptr, false);
        if (!json.is_object()) return;
        const std::string level = json.value("level", "");
        const int job = json.value("jobid", -1);
        JobEvent::Kind kind = JobEvent::Kind::finished;
        if (level == "job_info") {
            jobs_[job] = {JobEvent::Kind::started, json.value("patient", ""), json.value("stage", "")};
            kind = JobEvent::Kind::started;
        } else if (level == "job_error") {
            kind = JobEvent::Kind::failed;
        } else if (level != "job_finished") {
            return;
        }
        const auto found = jobs_.find(job);
        if (found == jobs_.end() || found->second.patient.empty()) return;
        found->second.kind = kind;
        on_event_(found->second);
    }

    const std::function<void(const JobEvent&)>& on_event_;
    std::string buffer_;
    std::map<int, JobEvent> jobs_;
};

// Reads until Snakemake closes its output; on an interrupt ends it and its jobs.
void follow(const Running& running, EventReader& reader) {
    bool told = false;
    std::array<char, 4096> bytes{};
    pollfd waiting{running.output, POLLIN, 0};
    for (;;) {
        if (cli::interrupt_asked() && !told) {
            kill(-running.pid, SIGINT);
            told = true;
        }
        if (poll(&waiting, 1, 200) <= 0) continue;
        const ssize_t count = ::read(running.output, bytes.data(), bytes.size());
        if (count > 0)
            reader.read({bytes.data(), static_cast<std::size_t>(count)});
        else if (count == 0)
            return;
    }
}

}  // namespace

void run_snakemake(const SnakemakeRun& run, const CohortFolder& folder,
                   const std::function<void(const JobEvent&)>& on_event) {
    cli::end_softly_on_interrupt();
    const Running running = start(command_of(run, folder), folder.snakemake_log());
    cli::pass_interrupts_to(running.pid);
    EventReader reader(on_event);
    follow(running, reader);
    close(running.output);
    int status = 0;
    while (waitpid(running.pid, &status, 0) < 0 && errno == EINTR) {
    }
    cli::pass_interrupts_to(0);
    if (cli::interrupt_asked()) throw cli::Interrupted();
    constexpr int not_found = 127;  // setpriv(1)
    if (WIFEXITED(status) && WEXITSTATUS(status) == not_found)
        throw SystemFailure({"snakemake", "is not installed", "", "apt-get install snakemake"});
    if (status != 0 && !reader.any())
        throw SystemFailure(
            {"snakemake", "ended before it ran a stage", "", "see " + folder.snakemake_log().string()});
}

}  // namespace palpate::cohort
