#pragma once

#include <concepts>
#include <cstdint>
#include <string_view>

namespace metier::hostile {

/// Takes fields off the front of a message in the Binary encoding; zeros and nothing beyond its
/// end, or where it is not well-formed: then ok() is false.
class Reader {
public:
    explicit Reader(std::string_view bytes) : rest_(bytes) {}

    bool ok() const { return ok_; }
    std::string_view rest() const { return rest_; }
    template <std::integral T>
    T number() {
        std::uint64_t value = 0;
        const auto bytes = raw(sizeof(T));
        for (std::size_t i = bytes.size(); i-- > 0;) {
            value = value << 8U | static_cast<unsigned char>(bytes[i]);
        }
        return static_cast<T>(value);
    }
    std::string_view raw(std::size_t size);
    /// String, ByteString; empty for null.
    std::string_view text();
    /// A NodeId as its bytes.
    std::string_view id();
    /// The number of an id of the standard's namespace; 0 for any other.
    std::uint32_t standardId();
    /// A DiagnosticInfo, without what it says.
    void skipDiagnostic(int depth = 0);
    void skipExtension();

private:
    std::string_view rest_;
    bool ok_ = true;
};

/// Begin of every response.
struct ResponseHeader {
    std::uint32_t type = 0;  ///< id of its Binary encoding
    std::uint32_t request = 0;
    std::uint32_t result = 0;  ///< StatusCode
};
ResponseHeader readHeader(Reader& reader);

}  // namespace metier::hostile
