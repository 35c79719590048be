// One process at a time draws a film, or each shard of it.
#pragma once

#include <filesystem>
#include <string>

namespace throng::tools {

// Holds a locked file for as long as the object lives; the last holder removes it. If another process holds the lock in
// a way that excludes this one, the constructor says so and waits. If files cannot be locked, as in some network
// folders, it holds nothing. A symbolic link of that name is a CommandError.
class FilmLock {
public:
    enum class Kind {
        kExclusive,
        kShared,  // any number of them at a time, but none beside an exclusive one
    };

    explicit FilmLock(std::filesystem::path file, Kind kind = Kind::kExclusive);
    ~FilmLock();

    // Tells the processes that wait what is being drawn. For exclusive locks.
    void write(const std::string& text) const;
    // What the previous holder wrote, if the constructor had to wait for it; else empty.
    const std::string& text_before() const { return text_before_; }

    FilmLock(const FilmLock&) = delete;
    FilmLock& operator=(const FilmLock&) = delete;

private:
    bool lock();  // false: try again, with the file opened anew

    std::filesystem::path path_;
    Kind kind_;
    int file_ = -1;
    bool has_waited_ = false;
    std::string text_before_;
};

}  // namespace throng::tools
