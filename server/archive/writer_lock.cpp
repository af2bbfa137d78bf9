// SPDX-License-Identifier: Apache-2.0
#include "server/archive/writer_lock.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace aeolis::archive {

namespace {

/// Whether the lock file still has its name: the last holder removes it, and a lock on a removed file excludes nobody.
bool still_named(int descriptor, const std::filesystem::path& file) {
    struct stat held{};
    struct stat named{};
    return ::fstat(descriptor, &held) == 0 && ::stat(file.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
           held.st_dev == named.st_dev;
}

/// Gives the lock file to the archive's owner. A file left behind by root would lock the owner out.
void give_to_owner(int descriptor, const std::filesystem::path& archive) {
    struct stat owner{};
    struct stat held{};
    // Somebody who may write the folder may have put another file there: only an empty file without other names is
    // given away.
    if (::fstat(descriptor, &held) != 0 || !S_ISREG(held.st_mode) || held.st_size != 0 || held.st_nlink != 1) return;
    const auto folder = std::filesystem::absolute(archive).parent_path();
    if (::geteuid() != 0 || (::stat(archive.c_str(), &owner) != 0 && ::stat(folder.c_str(), &owner) != 0)) return;
    if (::fchown(descriptor, owner.st_uid, owner.st_gid) != 0) return;  // the file system has no owners
}

}  // namespace

Result<WriterLock> WriterLock::take(const std::filesystem::path& archive) {
    auto file = archive;
    file += "-writer";
    for (;;) {
        int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
        if (descriptor < 0 && errno == EACCES)
            descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);  // another user's: enough for a lock
        if (descriptor < 0)
            return Error{archive.string() + ": cannot be written: " + file.string() + ": " + std::strerror(errno)};
        give_to_owner(descriptor, archive);
        if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
            ::close(descriptor);
            return Error{archive.string() + " is being written by another process"};
        }
        if (still_named(descriptor, file)) return WriterLock(std::move(file), descriptor);
        ::close(descriptor);
    }
}

WriterLock::~WriterLock() {
    if (descriptor_ < 0) return;
    ::unlink(file_.c_str());
    ::close(descriptor_);
}

}  // namespace aeolis::archive
