#include "parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "metier/base/text.hpp"

namespace metier::security {
namespace {

/// Far above what a log reaches; a greater number is that of another file, such as a copy with the
/// date in its name.
constexpr std::uint32_t kMostParts = 999'999;

/// The number in "<stem>.<number><extension>"; 0: it is no such name.
std::uint32_t numberIn(std::string_view name, std::string_view stem, std::string_view extension) {
    if (name.size() <= stem.size() + extension.size() + 1 || !name.starts_with(stem) ||
        !name.ends_with(extension) || name[stem.size()] != '.') {
        return 0;
    }
    const auto digits =
        name.substr(stem.size() + 1, name.size() - stem.size() - extension.size() - 1);
    return metier::numberIn<std::uint32_t>(digits).value_or(0);
}

}  // namespace

std::filesystem::path partOf(const std::filesystem::path& log, std::uint32_t number) {
    auto part = log;
    return number == 1 ? part
                       : part.replace_filename(fmt::format("{}.{}{}", log.stem().string(), number,
                                                           log.extension().string()));
}

std::uint32_t lastPart(const std::filesystem::path& log) {
    const auto stem = log.stem().string();
    const auto extension = log.extension().string();
    std::uint32_t last = 1;
    std::error_code none;  // no folder, no parts
    const auto folder = log.has_parent_path() ? log.parent_path() : std::filesystem::path(".");
    for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
        const auto name = entry.path().filename();
        const auto number = numberIn(name.string(), stem, extension);
        if (number <= kMostParts && name == partOf(log, number).filename()) {
            last = std::max(last, number);
        }
    }
    return last;
}

}  // namespace metier::security
