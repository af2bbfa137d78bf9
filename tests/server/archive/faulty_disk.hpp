// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

// A disk under SQLite that fails on demand.
namespace aeolis::test {

/// A shim over SQLite's own VFS. While it exists it is the default of this process, so that code that opens an archive
/// needs no change. Connections must be closed before it is destroyed.
///
/// Beside the real files, it records which octets of each database, journal and WAL are synced, and which are only
/// written. A power cut keeps the synced ones and, by its seed, some of the others, sector by sector, in any order.
/// Names follow the same rule: the creation or removal of a file is certain only once its folder is synced. Shared
/// memory is lost.
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
    /// Makes the n-th operation from now that `fault` concerns fail, counted from 1; if `lasting`, all later ones too,
    /// until mend().
    void fail_at(std::uint64_t nth, Fault fault, bool lasting);
    void mend();
    std::uint64_t failed() const;  ///< operations, since fail_at()

    /// Cuts the power at the n-th change (write, sync, truncate, removal) from now: it and all later ones fail.
    void cut_power_at(std::uint64_t nth);
    bool power_is_cut() const;
    std::uint64_t changes() const;  ///< since cut_power_at()

    /// Writes what is found when the power is back, under the files' own names, into another existing folder.
    void leave(const std::filesystem::path& folder, std::uint64_t seed) const;

    struct State;

  private:
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::test
