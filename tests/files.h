// Files that tests write and read.
#pragma once

#include <filesystem>
#include <string>

namespace throng::test {

// A temporary folder, removed with its files in the destructor.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::filesystem::path write(const std::string& name, const std::string& content) const;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

// Empty if the file cannot be read.
std::string read_file(const std::filesystem::path& path);

}  // namespace throng::test
