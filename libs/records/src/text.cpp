#include "text.hpp"

#include <algorithm>

#include "json_text.hpp"

namespace metier::records {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

bool isContinuation(char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

std::size_t longestOf(Form form) {
    return form == Form::name ? kLongestName : form == Form::key ? kLongestKey : kLongestText;
}

/// Cuts between characters.
void cut(std::string& text, std::size_t longest) {
    if (text.size() > longest) {
        while (longest > 0 && isContinuation(text[longest])) {
            --longest;
        }
        text.resize(longest);
    }
}

}  // namespace

std::string storable(std::string_view text, std::size_t longest) {
    // JSON knows no other text than UTF-8, but NUL. A character has four bytes at most.
    auto result =
        nlohmann::ordered_json::parse(dump(text.substr(0, longest + 4))).get<std::string>();
    for (auto nul = result.find('\0'); nul != std::string::npos; nul = result.find('\0', nul)) {
        result.replace(nul, 1, kReplacement);
    }
    cut(result, longest);
    return result;
}

/// Most texts are ASCII: they stay as they are.
void makeStorable(std::string& text, Form form) {
    const auto longest = longestOf(form);
    const bool plain = text.size() <= longest && std::all_of(text.begin(), text.end(), [](char c) {
                           return c > 0 && c <= '~';
                       });
    if (!plain) {
        text = storable(text, longest);
    }
}

}  // namespace metier::records
