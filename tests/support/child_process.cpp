// SPDX-License-Identifier: Apache-2.0
#include "tests/support/child_process.hpp"

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <iostream>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace aeolis::test {
namespace {

std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> all;
    all.reserve(words.size() + 1);
    for (auto& word : words) all.push_back(word.data());
    all.push_back(nullptr);
    return all;
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> words, const std::filesystem::path& output,
                           const Variables& variables) {
    std::vector<std::string> environment;
    for (char** one = environ; *one != nullptr; ++one) {
        const std::string entry{*one};
        if (!variables.contains(entry.substr(0, entry.find('=')))) environment.push_back(entry);
    }
    for (const auto& [name, value] : variables) environment.push_back(name + '=' + value);
    // All is ready before the fork: behind it only calls of the system are safe.
    const auto arguments = pointers(words), settings = pointers(environment);
    const auto out = output.empty() ? std::string{"/dev/null"} : output.string();
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ < 0) throw std::runtime_error("no process can be started");
    if (process_ > 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    const int nothing = ::open("/dev/null", O_RDONLY);
    const int streams = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (nothing < 0 || streams < 0) ::_exit(127);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(streams, STDOUT_FILENO);
    ::dup2(streams, STDERR_FILENO);
    ::execve(arguments[0], arguments.data(), settings.data());
    ::_exit(127);
}

ChildProcess ChildProcess::part(const std::string& test, const Variables& variables) {
    std::string name;
    for (const char letter : test) name += letter == ',' ? "\\," : std::string{letter};
    return ChildProcess{{"/proc/self/exe", name}, {}, variables};
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)), status_(other.status_) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
    if (this == &other) return *this;
    kill();
    process_ = std::exchange(other.process_, -1);
    status_ = other.status_;
    return *this;
}

ChildProcess::~ChildProcess() {
    kill();
}

bool ChildProcess::running() {
    if (process_ > 0 && ::waitpid(process_, &status_, WNOHANG) == process_) process_ = -1;
    return process_ > 0;
}

void ChildProcess::signal(int number) const {
    if (process_ > 0) ::kill(process_, number);
}

void ChildProcess::kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, &status_, 0);
    process_ = -1;
}

int ChildProcess::ended_within(std::chrono::seconds limit) {
    const auto until = std::chrono::steady_clock::now() + limit;
    while (running()) {
        if (std::chrono::steady_clock::now() > until) kill();
        std::this_thread::sleep_for(std::chrono::milliseconds{2});
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
}

Ended run(const std::string& program, const std::string& arguments, const std::filesystem::path& folder) {
    const auto there = folder.empty() ? std::string{} : "cd '" + folder.string() + "' && ";
    std::FILE* pipe = popen((there + "timeout 600 '" + program + "' " + arguments + " 2>&1 </dev/null").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("no process can be started");
    Ended ended;
    std::array<char, 4096> chunk{};
    for (std::size_t read = 0; (read = std::fread(chunk.data(), 1, chunk.size(), pipe)) > 0;)
        ended.text.append(chunk.data(), read);
    const int status = pclose(pipe);
    ended.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return ended;
}

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

std::string program() {
    auto named = variable("AEOLIS_PROGRAM");
    if (named.empty()) std::cout << "SKIPPED: AEOLIS_PROGRAM does not name the program to try\n";
    return named;
}

}  // namespace aeolis::test
