// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/must.hpp"

#include <csignal>
#include <new>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

// Clients in a process of their own, and what they share with the benchmark.
namespace aeolis::bench {

/// Memory that this process and those that it forks share. Unmapped with the object, in either process by itself.
template <typename T>
class Shared {
  public:
    Shared() {
        void* const memory = ::mmap(nullptr, sizeof(T), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        must(memory != MAP_FAILED, "mmap");
        value_ = new (memory) T;
    }
    ~Shared() { ::munmap(value_, sizeof(T)); }
    Shared(const Shared&) = delete;
    Shared& operator=(const Shared&) = delete;

    T& operator*() const { return *value_; }
    T* operator->() const { return value_; }

  private:
    T* value_;
};

/// Forks a process that is killed when this one ends. Call before any thread starts. @return its id; 0: this is it
inline pid_t fork_clients() {
    const pid_t process = ::fork();
    must(process >= 0, "fork");
    if (process == 0) ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    return process;
}

inline void kill_clients(pid_t process) {
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
}

}  // namespace aeolis::bench
