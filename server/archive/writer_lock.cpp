#include "server/archive/writer_lock.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace aeolis::archive {

namespace {

/// The last holder removes the file: a lock on a file that no longer has its name locks out nobody.
bool still_named(int descriptor, const std::filesystem::path& file) {
    struct stat held {};
    struct stat named {};
    return ::fstat(descriptor, &held) == 0 && ::stat(file.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
           held.st_dev == named.st_dev;
}

} // namespace

Result<WriterLock> WriterLock::take(const std::filesystem::path& archive) {
    auto file = archive;
    file += "-writer";
    for (;;) {
        const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (descriptor < 0) return Error{archive.string() + ": cannot be written: " + std::strerror(errno)};
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

} // namespace aeolis::archive
