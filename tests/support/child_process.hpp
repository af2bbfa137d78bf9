// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <sys/types.h>
#include <vector>

namespace aeolis::test {

/// Another program, without input. It is killed with this object, or when the thread that started it ends.
class ChildProcess {
  public:
    using Variables = std::map<std::string, std::string>;

    /// @param words      the program and its arguments
    /// @param output     what both its streams go to; empty: nothing keeps them
    /// @param variables  of its environment, beside those of this process
    explicit ChildProcess(std::vector<std::string> words, const std::filesystem::path& output = {},
                          const Variables& variables = {});
    /// This program again, as the test of this name, which [.part] keeps from being run by itself: a process that is
    /// killed, or that wants what this one has. A fork that goes on in this program would find the locks that other
    /// threads of it held.
    static ChildProcess part(const std::string& test, const Variables& variables);
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&& other) noexcept;
    ~ChildProcess();

    bool running();
    void signal(int number) const;
    void kill();  ///< as by kill -9, and gone when it returns
    /// Waits for its end. @return its exit code; -1: a signal ended it, or it was killed here as it did not end in time
    int ended_within(std::chrono::seconds limit = std::chrono::minutes{5});

  private:
    pid_t process_ = -1;
    int status_ = 0;  ///< once it has ended
};

struct Ended {
    int code = -1;     ///< of the exit; -1: a signal
    std::string text;  ///< of both streams
};
/// Runs a program without input, in `folder` if one is named, with arguments as a shell reads them. After ten minutes it
/// is told to end, so that what hangs fails by its name.
Ended run(const std::string& program, const std::string& arguments, const std::filesystem::path& folder = {});

/// A variable of the environment; empty: there is none.
std::string variable(const char* name);

/// The program that ./test has built beside the tests, maybe by another build type. Empty: none is named; then says on
/// the output that a test was skipped.
std::string program();

}  // namespace aeolis::test
