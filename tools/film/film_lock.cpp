#include "tools/film/film_lock.h"

#include "tools/cli/command.h"

#include <cerrno>
#include <fcntl.h>
#include <iostream>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace throng::tools {
namespace {

constexpr size_t kLongest = 1 << 20;  // of a text, bytes

}  // namespace

FilmLock::FilmLock(std::filesystem::path file, Kind kind) : path_(std::move(file)), kind_(kind) {
    while (!lock()) {}
}

// Returns false if the previous holder removed the file while this one waited: another file may have its name by then.
bool FilmLock::lock() {
    // O_NOFOLLOW: write() would empty what a link leads to
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file_ < 0 && errno == ELOOP)
        throw CommandError(path_.string() + ": is a symbolic link where the film's lock file must be; remove it");
    if (file_ < 0) return true;
    const int operation = kind_ == Kind::kShared ? LOCK_SH : LOCK_EX;
    if (::flock(file_, operation | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        if (!has_waited_)
            std::cerr << "throng: another process is drawing this film; waiting for it (" << path_.string() << ")\n";
        has_waited_ = true;
        if (::flock(file_, operation) != 0) return true;
        text_before_.resize(kLongest);
        const ssize_t length = ::pread(file_, text_before_.data(), text_before_.size(), 0);
        text_before_.resize(length > 0 ? static_cast<size_t>(length) : 0);
    }
    struct stat opened, there;
    if (::fstat(file_, &opened) == 0 && ::stat(path_.c_str(), &there) == 0 && opened.st_ino == there.st_ino &&
        opened.st_dev == there.st_dev)
        return true;
    ::close(file_);
    return false;
}

void FilmLock::write(const std::string& text) const {
    if (file_ < 0 || ::ftruncate(file_, 0) != 0) return;
    // If this fails, a process that waits finds another text, and does not take the film for its own.
    [[maybe_unused]] const ssize_t written = ::pwrite(file_, text.data(), text.size(), 0);
}

FilmLock::~FilmLock() {
    if (file_ < 0) return;
    // This fails while others share the lock, or if a waiting process takes it: then the last holder removes the file
    const bool is_shared = ::flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!is_shared) ::unlink(path_.c_str());
    ::close(file_);
}

}  // namespace throng::tools
