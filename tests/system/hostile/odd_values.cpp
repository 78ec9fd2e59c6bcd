#include "odd_values.hpp"

#include <array>

namespace metier::hostile {

namespace {

/// The built-in types (OPC 10000-6, 5.1.2).
enum Builtin : std::uint8_t {
    kBoolean = 1,
    kSByte = 2,
    kByte = 3,
    kInt16 = 4,
    kUInt16 = 5,
    kInt32 = 6,
    kUInt32 = 7,
    kInt64 = 8,
    kUInt64 = 9,
    kFloat = 10,
    kDouble = 11,
    kString = 12,
    kDateTime = 13,
    kGuid = 14,
    kByteString = 15,
    kXmlElement = 16,
    kNodeId = 17,
    kExpandedNodeId = 18,
    kStatusCode = 19,
    kQualifiedName = 20,
    kLocalizedText = 21,
    kExtensionObject = 22,
    kDataValue = 23,
    kVariant = 24,
    kDiagnosticInfo = 25,
};
constexpr unsigned kArray = 0x80;
constexpr unsigned kDimensions = 0x40;

void writeValue(Writer& writer, const Known& known, int depth);

void writeNumber(Writer& writer, unsigned type) {
    const auto value = writer.random().next();
    switch (type) {
        case kBoolean:
        case kSByte:
        case kByte:
            return writer.number(static_cast<std::uint8_t>(value));
        case kInt16:
        case kUInt16:
            return writer.number(static_cast<std::uint16_t>(value));
        case kInt64:
        case kUInt64:
            return writer.number(value);
        case kDouble:
            return writer.real(static_cast<double>(value % 200) - 100);
        default:
            return writer.number(static_cast<std::uint32_t>(value));
    }
}

void writeExtension(Writer& writer, int depth) {
    constexpr std::array<std::uint32_t, 8> encodings{298, 886, 889, 940, 15'396, 18'815, 24'134, 9};
    Writer body(writer.random(), 2);
    for (auto fields = writer.random().below(6); fields > 0 && depth > 0; --fields) {
        body.text("field");
    }
    writer.extension(writer.random().pick(encodings), body.bytes());
}

void writeOne(Writer& writer, const Known& known, unsigned type, int depth) {
    switch (type) {
        case kString:
        case kByteString:
        case kXmlElement:
            return writer.text("text");
        case kDateTime:
            return writer.time();
        case kGuid:
            return writer.raw("0123456789abcdef");
        case kNodeId:
            return writer.id(anyNode(writer.random(), known));
        case kExpandedNodeId:
            return writer.expandedId(anyNode(writer.random(), known));
        case kQualifiedName:
            return writer.qualifiedName(1, "name");
        case kLocalizedText:
            return writer.localizedText("text");
        case kExtensionObject:
            return writeExtension(writer, depth);
        case kDataValue:
            writer.exactly(std::uint8_t{1});
            return writeValue(writer, known, depth - 1);
        case kVariant:
            return writeValue(writer, known, depth - 1);
        case kDiagnosticInfo:
            return writeDiagnostic(writer);
        default:
            return writeNumber(writer, type);
    }
}

void writeArray(Writer& writer, const Known& known, unsigned type, int depth) {
    const bool shaped = writer.random().oneIn(4);
    const auto flags = kArray | (shaped ? kDimensions : 0U);
    const auto elements = writer.random().below(writer.random().oneIn(20) ? 400 : 9);
    writer.number(static_cast<std::uint8_t>(type | flags));
    writer.count(elements);
    for (std::size_t i = 0; i < elements; ++i) {
        writeOne(writer, known, type, depth);
    }
    if (shaped) {
        writer.count(2);
        writer.number(static_cast<std::uint32_t>(elements));
        writer.number(std::uint32_t{1});
    }
}

void writeValue(Writer& writer, const Known& known, int depth) {
    auto& random = writer.random();
    if (depth <= 0) {
        return writer.exactly(std::uint8_t{0});
    }
    const auto type = static_cast<unsigned>(1 + random.below(kDiagnosticInfo));
    if (type == kVariant || random.oneIn(3)) {
        return writeArray(writer, known, type, depth);
    }
    writer.number(static_cast<std::uint8_t>(type));
    writeOne(writer, known, type, depth);
}

/// Variants in one another, as deep as asked for.
void writeNested(Writer& writer, std::size_t depth) {
    for (std::size_t i = 0; i < depth; ++i) {
        if (writer.random().oneIn(2)) {
            writer.exactly(static_cast<std::uint8_t>(kVariant | kArray));
            writer.exactly(std::int32_t{1});
        } else {
            writer.exactly(static_cast<std::uint8_t>(kDataValue));
            writer.exactly(std::uint8_t{1});
        }
    }
    writer.exactly(static_cast<std::uint8_t>(kInt32));
    writer.exactly(std::int32_t{1});
}

}  // namespace

void writeVariant(Writer& writer, const Known& known) {
    constexpr std::array<std::size_t, 7> depths{2, 50, 99, 100, 101, 1'000, 8'000};
    if (writer.random().oneIn(30)) {
        return writeNested(writer, writer.random().pick(depths));
    }
    constexpr int deepest = 4;
    writeValue(writer, known, deepest);
}

void writeDataValue(Writer& writer, const Known& known) {
    constexpr unsigned has_value = 1;
    constexpr unsigned status = 2;
    constexpr unsigned source_time = 4;
    constexpr unsigned server_time = 8;
    constexpr unsigned source_picoseconds = 0x10;
    const auto fields =
        writer.random().oneIn(3) ? static_cast<unsigned>(writer.random().below(0x100)) : has_value;
    writer.exactly(static_cast<std::uint8_t>(fields));
    if ((fields & has_value) != 0) {
        writeVariant(writer, known);
    }
    if ((fields & status) != 0) {
        writer.number(std::uint32_t{0});
    }
    if ((fields & source_time) != 0) {
        writer.time();
    }
    if ((fields & source_picoseconds) != 0) {
        writer.number(std::uint16_t{0});
    }
    if ((fields & server_time) != 0) {
        writer.time();
    }
}

void writeDiagnostic(Writer& writer) {
    constexpr std::array<std::size_t, 5> depths{0, 1, 99, 101, 5'000};
    constexpr std::uint8_t inner = 0x40;
    const auto depth = writer.random().oneIn(8) ? writer.random().pick(depths) : 0;
    for (std::size_t i = 0; i < depth; ++i) {
        writer.exactly(inner);
    }
    writer.number(std::uint8_t{0});
}

const Bytes& anyNode(Random& random, const Known& known) {
    return random.pick(known.map.nodes);
}

const Bytes& anyVariable(Random& random, const Known& known) {
    return random.pick(known.map.variables);
}

std::uint32_t anySubscription(Random& random, const Known& known) {
    return known.subscriptions.empty() || random.oneIn(8)
               ? static_cast<std::uint32_t>(random.below(5'000))
               : random.pick(known.subscriptions);
}

std::uint32_t anyItem(Random& random, const Known& known) {
    return known.items.empty() || random.oneIn(8) ? static_cast<std::uint32_t>(random.below(500))
                                                  : random.pick(known.items);
}

}  // namespace metier::hostile
