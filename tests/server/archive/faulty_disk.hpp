// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

// A disk that fails when it is told to, under SQLite.
namespace aeolis::test {

/// A shim over SQLite's own VFS. While it lives it is the default of this process, so that what opens an archive needs
/// no word about it; connections must be closed before it goes.
///
/// Keeps, beside the real files, what of each database, journal and WAL is synced, and what is only written: a power
/// cut leaves the first, and of the second what its seed says, sector by sector, in any order. Names follow the same
/// rule: a file that was made or removed is sure to be so only once its folder is synced. Shared memory is lost.
class FaultyDisk {
  public:
    FaultyDisk();
    ~FaultyDisk();
    FaultyDisk(const FaultyDisk&) = delete;
    FaultyDisk& operator=(const FaultyDisk&) = delete;

    enum class Fault : std::uint8_t {
        input_output,  ///< any operation: open, read, write, sync, truncate, remove, shared memory
        full,          ///< what needs room: half of it is written, then there is none
        read_only,     ///< what changes a file, as when the kernel has mounted a sick disk read-only
    };
    /// From the n-th operation on that `fault` can strike, counted from 1 and from now: this one, or all until mend().
    void fail_at(std::uint64_t nth, Fault fault, bool lasting);
    void mend();
    std::uint64_t failed() const;  ///< operations, since fail_at()

    /// The power goes with the n-th change (write, sync, truncate, removal) from now: it and all after it fail.
    void cut_power_at(std::uint64_t nth);
    bool power_is_cut() const;
    std::uint64_t changes() const;  ///< since cut_power_at()

    /// What is found when the power is back, under the files' own names, in another folder that is there.
    void leave(const std::filesystem::path& folder, std::uint64_t seed) const;

    struct State;

  private:
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::test
