#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "random.hpp"

namespace metier::hostile {

/// Number of the attribute Value.
inline constexpr std::uint32_t kValueAttribute = 13;

/// Bytes of the OPC UA Binary encoding (OPC 10000-6, 5.2).
using Bytes = std::string;

/// NodeIds as their bytes.
Bytes numericId(std::uint16_t namespace_index, std::uint32_t id);
Bytes textId(std::uint16_t namespace_index, std::string_view id);
/// NodeId in the standard's namespace.
inline Bytes standardId(std::uint32_t id) {
    return numericId(0, id);
}

/// Encodes a message of which one in so many fields is wrong: lengths lie, text is no UTF-8,
/// numbers are at the ends of their range, NodeIds name nothing.
class Writer {
public:
    /// \param wrong_one_in 0: everything is right
    Writer(Random& random, std::size_t wrong_one_in)
        : random_(random), wrong_one_in_(wrong_one_in) {}

    Random& random() { return random_; }
    /// An empty one that errs as often, for what is written as a whole.
    Writer fresh() const { return {random_, wrong_one_in_}; }
    /// Whether the next field shall be wrong.
    bool isWrong() { return random_.oneIn(wrong_one_in_); }
    const Bytes& bytes() const { return bytes_; }
    Bytes take() { return std::move(bytes_); }

    /// As they are.
    void raw(std::string_view bytes) { bytes_.append(bytes); }
    template <std::integral T>
    void exactly(T value) {
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            bytes_.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
        }
    }
    void exactText(std::string_view text);

    /// A number, or another one.
    template <std::integral T>
    void number(T value) {
        exactly(isWrong() ? static_cast<T>(oddInteger()) : value);
    }
    void real(double value);
    void boolean(bool value) { number(static_cast<std::uint8_t>(value)); }
    /// Writes the number of the elements that follow.
    void count(std::size_t elements);
    /// String, ByteString.
    void text(std::string_view text);
    void noText() { exactly(std::int32_t{-1}); }
    void id(std::string_view node_id);
    /// ExpandedNodeId, of which a plain one is one kind.
    void expandedId(std::string_view node_id);
    void qualifiedName(std::uint16_t namespace_index, std::string_view name);
    void localizedText(std::string_view text);
    void time();
    /// An ExtensionObject: type and body.
    void extension(std::uint32_t encoding_id, std::string_view body);

    std::uint64_t oddInteger();
    double oddReal();
    /// Invalid UTF-8, control characters, terminal escapes, very long text.
    Bytes oddText();
    Bytes oddId();

private:
    Random& random_;
    std::size_t wrong_one_in_;
    Bytes bytes_;
};

}  // namespace metier::hostile
