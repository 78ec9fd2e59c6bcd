#pragma once

#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "metier/base/error.hpp"

namespace metier::security {

/// An open file; closed at its end.
class Descriptor {
public:
    explicit Descriptor(int value = -1) noexcept : value_(value) {}
    ~Descriptor();
    Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(value_, other.value_);
        return *this;
    }
    int get() const noexcept { return value_; }
    explicit operator bool() const noexcept { return value_ >= 0; }

private:
    int value_;
};

/// Error resource_unavailable with the file's name and the system's reason.
tl::unexpected<Error> failed(const std::filesystem::path& file, int error = errno);

/// Makes missing folders, accessible to their owner only.
/// Errors: resource_unavailable.
Result<void> makeFolder(const std::filesystem::path& folder);

/// Writes all of `content`; false with errno if the system refuses.
bool writeAll(const Descriptor& file, std::string_view content);

enum class Readers { owner, everybody };

/// Writes a file whole or not at all: a reader sees the old or the new content, also after a loss
/// of power. Missing folders are made, accessible to their owner only.
/// Errors: resource_unavailable.
Result<void> writeWhole(const std::filesystem::path& file, std::string_view content,
                        Readers readers);

/// The content of a file, up to 64 kB, that its owner alone may read.
/// Errors: not_found; access_denied (others may read it); invalid_argument (it cannot be read, or
///         is larger).
Result<std::string> readPrivate(const std::filesystem::path& file);

}  // namespace metier::security
