// One process at a time draws a film, or a shard of it.
#pragma once

#include <filesystem>
#include <string>

namespace throng::tools {

// Holds a locked file for as long as the object lives, then removes it. If another process holds the lock, the
// constructor says so and waits. If files cannot be locked, as in some network folders, it holds nothing.
class FilmLock {
public:
    explicit FilmLock(std::filesystem::path file);
    ~FilmLock();

    // Tells the processes that wait what is being drawn.
    void write(const std::string& text) const;
    // What the previous holder wrote, if the constructor had to wait for it; else empty.
    const std::string& text_before() const { return text_before_; }

    FilmLock(const FilmLock&) = delete;
    FilmLock& operator=(const FilmLock&) = delete;

private:
    bool lock();  // false: try again, with the file opened anew

    std::filesystem::path path_;
    int file_ = -1;
    bool has_waited_ = false;
    std::string text_before_;
};

}  // namespace throng::tools
