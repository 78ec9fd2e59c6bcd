#include "parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "metier/base/text.hpp"

namespace metier::security {
namespace {

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
    for (const auto& entry : std::filesystem::directory_iterator(log.parent_path(), none)) {
        last = std::max(last, numberIn(entry.path().filename().string(), stem, extension));
    }
    return last;
}

}  // namespace metier::security
