// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"

#include <chrono>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <thread>
#include <unistd.h>

// What a process has made durable, by its own word, before it is killed: the newest sequence number, in a file beside
// its archive.
namespace aeolis::test {

inline std::filesystem::path acknowledged_file(const std::filesystem::path& archive) {
    return archive.string() + ".acknowledged";
}

/// 0: nothing yet.
inline archive::Sequence last_acknowledged(const std::filesystem::path& archive) {
    std::ifstream in{acknowledged_file(archive), std::ios::binary};
    archive::Sequence seq = 0;
    return in.read(reinterpret_cast<char*>(&seq), sizeof seq) ? seq : 0;
}

class Acknowledging {
  public:
    explicit Acknowledging(const std::filesystem::path& archive)
        : file_(::open(acknowledged_file(archive).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) {}
    Acknowledging(const Acknowledging&) = delete;
    Acknowledging& operator=(const Acknowledging&) = delete;
    ~Acknowledging() { ::close(file_); }

    void operator()(archive::Sequence seq) const {
        if (::pwrite(file_, &seq, sizeof seq, 0) != sizeof seq) ::_exit(1);
    }

  private:
    int file_;
};

/// Kills a process once it has acknowledged so much, or has ended by itself. @return what it had acknowledged
inline archive::Sequence killed_after(ChildProcess& process, archive::Sequence published,
                                      const std::filesystem::path& archive) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes{5};
    while (last_acknowledged(archive) < published && process.running() && std::chrono::steady_clock::now() < until)
        std::this_thread::sleep_for(std::chrono::milliseconds{1});
    process.kill();
    return last_acknowledged(archive);
}

}  // namespace aeolis::test
