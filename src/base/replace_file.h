// Writing a file as a whole.
#pragma once

#include "base/failure.h"

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <span>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace throng {

// Follows symbolic links to the final target, which need not exist. Other paths are returned as they are.
inline std::filesystem::path link_target(std::filesystem::path path) {
    namespace fs = std::filesystem;
    constexpr int kMaxLinks = 40;  // the limit of Linux
    std::error_code error;
    for (int links = 0; links < kMaxLinks && fs::is_symlink(fs::symlink_status(path, error)); ++links)
        path = path.parent_path() / fs::read_symlink(path, error);  // an absolute target replaces the folder
    return path;
}

// Creates an empty file beside `path`, under a temporary name that it stores in `unfinished`, and opens it for writing.
// Returns -1 and sets errno if that fails.
inline int open_beside(const std::filesystem::path& path, std::filesystem::path& unfinished) {
    // O_EXCL: no two calls write to one file, and no link of that name is followed
    for (unsigned attempt = 0;; ++attempt) {
        unfinished = path.string() + ".part" + std::to_string(getpid()) + "." + std::to_string(attempt);
        const int file = ::open(unfinished.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0 || errno != EEXIST) return file;
    }
}

// Writes a new file beside `name`, or beside the target if `name` is a symbolic link, then moves it to that name with
// `take_name`, which is rename() or behaves like it. If it replaces a file, it keeps that file's permissions. Returns
// 0, or the errno of the step that failed.
template <class TakeName>
int write_beside(const std::filesystem::path& name, std::span<const std::byte> bytes, TakeName take_name) {
    namespace fs = std::filesystem;
    const auto fail = [&](const std::string& what) { throw Failure(ErrorCode::kFile, name.string(), what); };
    const fs::path path = link_target(name);
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    const bool replaces = status.type() == fs::file_type::regular;
    if (status.type() != fs::file_type::not_found && !replaces) fail("exists and is not a regular file");

    fs::path unfinished;
    const int file = open_beside(path, unfinished);
    if (file < 0) fail("cannot be written: " + std::generic_category().message(errno));
    int reason = 0;
    if (replaces) ::fchmod(file, static_cast<mode_t>(status.permissions() & fs::perms::all));
    while (!bytes.empty() && reason == 0) {
        const ssize_t count = ::write(file, bytes.data(), bytes.size());
        if (count >= 0)
            bytes = bytes.subspan(static_cast<size_t>(count));
        else if (errno != EINTR)
            reason = errno;
    }
    if (::close(file) != 0 && reason == 0) reason = errno;
    if (reason == 0 && take_name(unfinished.c_str(), path.c_str()) != 0) reason = errno;
    if (reason != 0) ::unlink(unfinished.c_str());
    return reason;
}

inline void check_written(const std::filesystem::path& path, int reason) {
    if (reason != 0)
        throw Failure(ErrorCode::kFile, path.string(), "cannot be written: " + std::generic_category().message(reason));
}

// Replaces the file atomically: readers of `path` see the old file or the new one, never a part. If it fails, throws
// kFile with the system's reason and leaves no temporary file behind.
inline void replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    check_written(path, write_beside(path, bytes, ::rename));
}

// Like rename(), but fails with EEXIST if `name` exists.
inline int take_free_name(const char* unfinished, const char* name) {
    if (::link(unfinished, name) == 0) return ::unlink(unfinished);
    if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS) return -1;
    // The file system has no hard links
    if (::renameat2(AT_FDCWD, unfinished, AT_FDCWD, name, RENAME_NOREPLACE) == 0) return 0;
    if (errno != EINVAL && errno != ENOSYS) return -1;
    // Nor does it support renameat2(): create an empty file to claim the name, then replace that file
    const int created = ::open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (created < 0) return -1;
    ::close(created);
    if (::rename(unfinished, name) == 0) return 0;
    const int reason = errno;
    ::unlink(name);
    errno = reason;
    return -1;
}

// Like replace_file(), but keeps a file that exists already. If several calls race, one of them creates the file. On
// file systems without hard links and renameat2(), readers may see it empty for a moment.
inline void create_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    const int reason = write_beside(path, bytes, take_free_name);
    if (reason != EEXIST) check_written(path, reason);
}

}  // namespace throng
