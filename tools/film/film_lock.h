// One process at a time draws a film, or a shard of it.
#pragma once

#include <filesystem>
#include <string>

namespace throng::tools {

// Held while one lives: a file that is locked, and gone afterwards. Where another process holds it, the constructor
// says so and waits. Where files cannot be locked, as in some folders of a network, nothing is held.
class FilmLock {
public:
    explicit FilmLock(std::filesystem::path file);
    ~FilmLock();

    // For those who wait: what is drawn while this is held.
    void write(const std::string& text) const;
    // What was written by who held it before, where the constructor has waited; else empty.
    const std::string& text_before() const { return text_before_; }

    FilmLock(const FilmLock&) = delete;
    FilmLock& operator=(const FilmLock&) = delete;

private:
    bool lock();  // false: it is to be opened anew

    std::filesystem::path path_;
    int file_ = -1;
    bool has_waited_ = false;
    std::string text_before_;
};

}  // namespace throng::tools
