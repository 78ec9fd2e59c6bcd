#include "wire.hpp"

namespace metier::ur_driver {

namespace {

constexpr std::size_t kLongestText = 300;

}  // namespace

std::string printable(std::string_view raw) {
    std::string text;
    for (const char character : raw.substr(0, kLongestText)) {
        const auto code = static_cast<unsigned char>(character);
        text += code >= 0x20 && code < 0x7f ? character : ' ';
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

}  // namespace metier::ur_driver
