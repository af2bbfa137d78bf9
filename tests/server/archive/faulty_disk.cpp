// SPDX-License-Identifier: Apache-2.0
#include "tests/server/archive/faulty_disk.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <list>
#include <map>
#include <mutex>
#include <new>
#include <random>
#include <sqlite3.h>
#include <string>
#include <vector>

namespace aeolis::test {
namespace {

constexpr std::size_t sector_octets = 512;  // what a disk writes whole or not at all
constexpr const char* shim_name = "aeolis-faulty-disk";

/// A write, or with no octets a change of size.
struct Change {
    std::size_t at = 0;
    std::vector<std::uint8_t> octets;
    bool resize = false;
};

void apply(const Change& change, std::vector<std::uint8_t>& contents) {
    if (change.resize) return contents.resize(change.at);
    contents.resize(std::max(contents.size(), change.at + change.octets.size()));
    std::ranges::copy(change.octets, contents.begin() + static_cast<std::ptrdiff_t>(change.at));
}

/// A file that a crash can spoil.
struct Kept {
    std::vector<std::uint8_t> synced;
    std::vector<Change> written;  ///< since then
    bool named = false;           ///< its name is synced
    bool removed = false;         ///< but that is not synced
    bool syncs_folder = false;    ///< SQLite syncs the folder with the first sync of a new journal or WAL
};

enum class Kind : std::uint8_t { open, read, write, sync, truncate, remove, shared_memory };

int error_code(Kind kind, FaultyDisk::Fault fault) {
    if (fault == FaultyDisk::Fault::read_only) return SQLITE_READONLY;
    switch (kind) {
    case Kind::open: return SQLITE_CANTOPEN;
    case Kind::read: return SQLITE_IOERR_READ;
    case Kind::write: return fault == FaultyDisk::Fault::full ? SQLITE_FULL : SQLITE_IOERR_WRITE;
    case Kind::sync: return SQLITE_IOERR_FSYNC;
    case Kind::truncate: return SQLITE_IOERR_TRUNCATE;
    case Kind::remove: return SQLITE_IOERR_DELETE;
    case Kind::shared_memory: return SQLITE_IOERR_SHMSIZE;
    }
    return SQLITE_IOERR;
}

}  // namespace

struct FaultyDisk::State {
    /// What an operation comes to before the disk is asked: SQLITE_OK, or the code that it fails with.
    int strike(Kind kind);
    void sync_folder();

    mutable std::mutex mutex;
    sqlite3_vfs* real = nullptr;
    sqlite3_vfs shim{};
    sqlite3_io_methods methods{};
    std::map<std::string, Kept*> files;
    std::list<Kept> kept;  ///< also of names that are gone: a connection may still have the file open

    std::uint64_t fail_nth = 0, operations = 0, failed = 0;
    Fault fault{};
    bool lasting = false;
    std::uint64_t cut_nth = 0, changes = 0;
    bool cut = false;
};

namespace {

using State = FaultyDisk::State;

/// SQLite's file object; the real one stands behind it.
struct File {
    sqlite3_file base;
    State* state;
    Kept* kept;  ///< null: a temporary file
};
static_assert(sizeof(File) % 8 == 0);  // as SQLite aligns its own

File& shim_of(sqlite3_file* file) {
    return *reinterpret_cast<File*>(file);
}
sqlite3_file* real_of(sqlite3_file* file) {
    return reinterpret_cast<sqlite3_file*>(reinterpret_cast<File*>(file) + 1);
}
State& state_of(sqlite3_vfs* vfs) {
    return *static_cast<State*>(vfs->pAppData);
}

}  // namespace

int FaultyDisk::State::strike(Kind kind) {
    const bool changing = kind == Kind::write || kind == Kind::sync || kind == Kind::truncate || kind == Kind::remove;
    if (changing && ++changes == cut_nth) cut = true;
    if (cut) return error_code(kind, Fault::input_output);
    if (fail_nth == 0) return SQLITE_OK;
    if (fault == Fault::full && kind != Kind::write && kind != Kind::shared_memory) return SQLITE_OK;
    if (fault == Fault::read_only && kind != Kind::write && kind != Kind::truncate && kind != Kind::remove)
        return SQLITE_OK;
    ++operations;
    if (operations != fail_nth && (!lasting || operations < fail_nth)) return SQLITE_OK;
    ++failed;
    return error_code(kind, fault);
}

void FaultyDisk::State::sync_folder() {
    std::erase_if(files, [](const auto& entry) { return entry.second->removed; });
    for (auto& [name, file] : files) file->named = true;
}

namespace {

int close_file(sqlite3_file* file) {
    return real_of(file)->pMethods->xClose(real_of(file));
}

int read_file(sqlite3_file* file, void* octets, int count, sqlite3_int64 at) {
    auto& state = *shim_of(file).state;
    const std::scoped_lock lock{state.mutex};
    if (const int code = state.strike(Kind::read); code != SQLITE_OK) return code;
    return real_of(file)->pMethods->xRead(real_of(file), octets, count, at);
}

int write_file(sqlite3_file* file, const void* octets, int count, sqlite3_int64 at) {
    auto& state = *shim_of(file).state;
    const std::scoped_lock lock{state.mutex};
    const bool was_cut = state.cut;
    const int code = state.strike(Kind::write);
    // The write in which the power goes may still reach the disk, in part; a full disk takes half.
    const int reaches = code == SQLITE_OK || (state.cut && !was_cut) ? count : code == SQLITE_FULL ? count / 2 : 0;
    if (auto* kept = shim_of(file).kept; kept != nullptr && reaches > 0) {
        const auto* first = static_cast<const std::uint8_t*>(octets);
        kept->written.push_back({static_cast<std::size_t>(at), {first, first + reaches}, false});
    }
    if (reaches > 0 && !state.cut) {
        const int written = real_of(file)->pMethods->xWrite(real_of(file), octets, reaches, at);
        if (written != SQLITE_OK) return written;
    }
    return code;
}

int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
    auto& state = *shim_of(file).state;
    const std::scoped_lock lock{state.mutex};
    if (const int code = state.strike(Kind::truncate); code != SQLITE_OK) return code;
    if (auto* kept = shim_of(file).kept) kept->written.push_back({static_cast<std::size_t>(size), {}, true});
    return real_of(file)->pMethods->xTruncate(real_of(file), size);
}

int sync_file(sqlite3_file* file, int flags) {
    auto& state = *shim_of(file).state;
    const std::scoped_lock lock{state.mutex};
    auto* kept = shim_of(file).kept;
    if (const int code = state.strike(Kind::sync); code != SQLITE_OK) {
        // The kernel takes pages that it could not write for clean: a second sync finds nothing to do.
        if (kept != nullptr && !state.cut) kept->written.clear();
        return code;
    }
    if (kept != nullptr) {
        for (const auto& change : kept->written) apply(change, kept->synced);
        kept->written.clear();
        if (kept->syncs_folder) state.sync_folder();
        kept->syncs_folder = false;
    }
    return real_of(file)->pMethods->xSync(real_of(file), flags);
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
    return real_of(file)->pMethods->xFileSize(real_of(file), size);
}
int lock_file(sqlite3_file* file, int level) {
    return real_of(file)->pMethods->xLock(real_of(file), level);
}
int unlock_file(sqlite3_file* file, int level) {
    return real_of(file)->pMethods->xUnlock(real_of(file), level);
}
int check_reserved(sqlite3_file* file, int* reserved) {
    return real_of(file)->pMethods->xCheckReservedLock(real_of(file), reserved);
}
int control_file(sqlite3_file* file, int operation, void* argument) {
    return real_of(file)->pMethods->xFileControl(real_of(file), operation, argument);
}
int sector_size(sqlite3_file* file) {
    return real_of(file)->pMethods->xSectorSize(real_of(file));
}
int characteristics(sqlite3_file* file) {
    return real_of(file)->pMethods->xDeviceCharacteristics(real_of(file));
}
int map_shared(sqlite3_file* file, int region, int size, int extend, void volatile** memory) {
    auto& state = *shim_of(file).state;
    const std::scoped_lock lock{state.mutex};
    if (const int code = state.strike(Kind::shared_memory); code != SQLITE_OK) return code;
    return real_of(file)->pMethods->xShmMap(real_of(file), region, size, extend, memory);
}
int lock_shared(sqlite3_file* file, int offset, int count, int flags) {
    return real_of(file)->pMethods->xShmLock(real_of(file), offset, count, flags);
}
void barrier_shared(sqlite3_file* file) {
    real_of(file)->pMethods->xShmBarrier(real_of(file));
}
int unmap_shared(sqlite3_file* file, int remove) {
    return real_of(file)->pMethods->xShmUnmap(real_of(file), remove);
}

std::vector<std::uint8_t> contents_of(const char* name) {
    std::ifstream file{name, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

int open_file(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* flags_out) {
    auto& state = state_of(vfs);
    auto& opened = *new (file) File{{nullptr}, &state, nullptr};
    const std::scoped_lock lock{state.mutex};
    if (const int code = state.strike(Kind::open); code != SQLITE_OK) return code;
    const bool keep =
        name != nullptr && (flags & (SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_WAL)) != 0;
    const bool there = keep && std::filesystem::exists(name);
    if (const int code = state.real->xOpen(state.real, name, real_of(file), flags, flags_out); code != SQLITE_OK)
        return code;
    opened.base.pMethods = &state.methods;
    if (!keep) return SQLITE_OK;
    auto& entry = state.files[name];
    if (entry == nullptr || entry->removed) {
        entry = &state.kept.emplace_back();
        entry->named = there;
        if (there) entry->synced = contents_of(name);
        entry->syncs_folder = !there && (flags & SQLITE_OPEN_MAIN_DB) == 0;
    }
    opened.kept = entry;
    return SQLITE_OK;
}

int remove_file(sqlite3_vfs* vfs, const char* name, int sync_folder) {
    auto& state = state_of(vfs);
    const std::scoped_lock lock{state.mutex};
    if (const int code = state.strike(Kind::remove); code != SQLITE_OK) return code;
    const int removed = state.real->xDelete(state.real, name, sync_folder);
    if (removed != SQLITE_OK) return removed;
    if (const auto found = state.files.find(name); found != state.files.end()) found->second->removed = true;
    if (sync_folder != 0) state.sync_folder();
    return SQLITE_OK;
}

}  // namespace

FaultyDisk::FaultyDisk() : state_(std::make_unique<State>()) {
    auto& state = *state_;
    state.real = sqlite3_vfs_find(nullptr);
    AEOLIS_CHECK(state.real != nullptr && std::strcmp(state.real->zName, shim_name) != 0);  // one at a time
    state.methods = {
        2,           close_file,     read_file,      write_file,   truncate_file, sync_file,       file_size,
        lock_file,   unlock_file,    check_reserved, control_file, sector_size,   characteristics, map_shared,
        lock_shared, barrier_shared, unmap_shared,   nullptr,      nullptr};
    state.shim = *state.real;  // paths, randomness, time: the real one's, which take the VFS only for its data
    state.shim.szOsFile = static_cast<int>(sizeof(File)) + state.real->szOsFile;
    state.shim.pNext = nullptr;
    state.shim.zName = shim_name;
    state.shim.pAppData = state_.get();
    state.shim.xOpen = open_file;
    state.shim.xDelete = remove_file;
    AEOLIS_CHECK(sqlite3_vfs_register(&state.shim, 1) == SQLITE_OK);
}

FaultyDisk::~FaultyDisk() {
    sqlite3_vfs_unregister(&state_->shim);
    sqlite3_vfs_register(state_->real, 1);
}

void FaultyDisk::fail_at(std::uint64_t nth, Fault fault, bool lasting) {
    const std::scoped_lock lock{state_->mutex};
    state_->fail_nth = nth;
    state_->fault = fault;
    state_->lasting = lasting;
    state_->operations = state_->failed = 0;
}
void FaultyDisk::mend() {
    const std::scoped_lock lock{state_->mutex};
    state_->fail_nth = 0;
}
std::uint64_t FaultyDisk::failed() const {
    const std::scoped_lock lock{state_->mutex};
    return state_->failed;
}
void FaultyDisk::cut_power_at(std::uint64_t nth) {
    const std::scoped_lock lock{state_->mutex};
    state_->cut_nth = nth;
    state_->changes = 0;
}
bool FaultyDisk::power_is_cut() const {
    const std::scoped_lock lock{state_->mutex};
    return state_->cut;
}
std::uint64_t FaultyDisk::changes() const {
    const std::scoped_lock lock{state_->mutex};
    return state_->changes;
}

void FaultyDisk::leave(const std::filesystem::path& folder, std::uint64_t seed) const {
    const std::scoped_lock lock{state_->mutex};
    std::mt19937_64 random{seed};
    // A seed also chooses how much comes through: little, or nearly all.
    const auto fraction = static_cast<double>(random() % 5) / 4.0;
    const auto survives = [&] { return static_cast<double>(random() % 1024) < fraction * 1024.0; };
    for (const auto& [name, file] : state_->files) {
        if (file->removed && survives()) continue;
        if (!file->named && !survives()) continue;
        auto contents = file->synced;
        for (const auto& change : file->written) {
            if (change.resize) {
                if (survives()) apply(change, contents);
                continue;
            }
            // By sectors of the disk, not of the write.
            for (std::size_t at = change.at; at < change.at + change.octets.size();) {
                const std::size_t end =
                    std::min((at / sector_octets + 1) * sector_octets, change.at + change.octets.size());
                const auto* first = change.octets.data() + (at - change.at);
                if (survives()) apply({at, {first, first + (end - at)}, false}, contents);
                at = end;
            }
        }
        std::ofstream{folder / std::filesystem::path{name}.filename(), std::ios::binary}.write(
            reinterpret_cast<const char*>(contents.data()), static_cast<std::streamsize>(contents.size()));
    }
}

}  // namespace aeolis::test
