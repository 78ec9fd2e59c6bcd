#include "reader.hpp"

namespace metier::hostile {

std::string_view Reader::raw(std::size_t size) {
    if (size > rest_.size()) {
        ok_ = false;
        rest_ = {};
        return {};
    }
    const auto taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
}

std::string_view Reader::text() {
    const auto length = number<std::int32_t>();
    return length <= 0 ? std::string_view() : raw(static_cast<std::size_t>(length));
}

std::string_view Reader::id() {
    const auto* begin = rest_.data();
    const auto before = rest_.size();
    switch (number<std::uint8_t>()) {
        case 0:
            raw(1);
            break;
        case 1:
            raw(3);
            break;
        case 2:
            raw(6);
            break;
        case 3:
        case 5:
            raw(2);
            text();
            break;
        case 4:
            raw(18);
            break;
        default:
            ok_ = false;
    }
    return ok_ ? std::string_view(begin, before - rest_.size()) : std::string_view();
}

std::uint32_t Reader::standardId() {
    Reader id(this->id());
    switch (id.number<std::uint8_t>()) {
        case 0:
            return id.number<std::uint8_t>();
        case 1:
            return id.number<std::uint8_t>() == 0 ? id.number<std::uint16_t>() : 0;
        case 2:
            return id.number<std::uint16_t>() == 0 ? id.number<std::uint32_t>() : 0;
        default:
            return 0;
    }
}

void Reader::skipDiagnostic(int depth) {
    constexpr int deepest = 10;
    constexpr unsigned has_text = 0x10;
    constexpr unsigned status = 0x20;
    constexpr unsigned inner = 0x40;
    const auto fields = number<std::uint8_t>();
    for (unsigned bit = 1; bit < has_text; bit <<= 1U) {
        raw((fields & bit) != 0 ? sizeof(std::int32_t) : 0);
    }
    if ((fields & has_text) != 0) {
        text();
    }
    raw((fields & status) != 0 ? sizeof(std::uint32_t) : 0);
    if ((fields & inner) != 0 && depth < deepest) {
        skipDiagnostic(depth + 1);
    }
}

void Reader::skipExtension() {
    id();
    if (number<std::uint8_t>() != 0) {
        text();
    }
}

ResponseHeader readHeader(Reader& reader) {
    ResponseHeader header;
    header.type = reader.standardId();
    reader.number<std::uint64_t>();
    header.request = reader.number<std::uint32_t>();
    header.result = reader.number<std::uint32_t>();
    reader.skipDiagnostic();
    for (auto texts = reader.number<std::int32_t>(); texts > 0 && reader.ok(); --texts) {
        reader.text();
    }
    reader.skipExtension();
    return header;
}

}  // namespace metier::hostile
