#include "filters.hpp"

#include <array>
#include <string_view>

#include "odd_values.hpp"

namespace metier::hostile {

namespace {

constexpr std::uint32_t kBaseEventType = 2041;
constexpr std::size_t kOperators = 18;

void writeSimpleOperand(Writer& writer) {
    constexpr std::array<std::string_view, 6> field_names{"EventType",  "Message",    "Severity",
                                                          "SourceNode", "Transition", "FromState"};
    constexpr std::array<std::uint32_t, 3> types{kBaseEventType, 2378, 58};
    writer.id(standardId(writer.random().pick(types)));
    const auto names = writer.random().oneIn(50) ? writer.random().below(500) : 1;
    writer.count(names);
    for (std::size_t i = 0; i < names; ++i) {
        writer.qualifiedName(0, writer.random().pick(field_names));
    }
    writer.number(kValueAttribute);
    if (writer.isWrong()) {
        return writer.exactText("1:2,3:");
    }
    writer.noText();
}

void writeAttributeOperand(Writer& writer, const Known& known) {
    writer.id(anyNode(writer.random(), known));
    writer.text("alias");
    writer.count(1);
    writer.id(standardId(33));
    writer.boolean(false);
    writer.boolean(true);
    writer.qualifiedName(0, "Message");
    writer.number(kValueAttribute);
    writer.noText();
}

void writeOperand(Writer& writer, const Known& known, std::size_t elements) {
    constexpr std::uint32_t element = 594;
    constexpr std::uint32_t literal = 597;
    constexpr std::uint32_t attribute = 600;
    constexpr std::uint32_t simple_attribute = 603;
    Writer body = writer.fresh();
    switch (writer.random().below(5)) {
        case 0:
            body.number(static_cast<std::uint32_t>(writer.random().below(elements + 1)));
            return writer.extension(element, body.bytes());
        case 1:
            writeAttributeOperand(body, known);
            return writer.extension(attribute, body.bytes());
        case 2:
            writeSimpleOperand(body);
            return writer.extension(simple_attribute, body.bytes());
        default:
            writeVariant(body, known);
            return writer.extension(literal, body.bytes());
    }
}

void writeEventFilter(Writer& writer, const Known& known) {
    const auto fields = writer.random().oneIn(20) ? writer.random().below(300) : 3;
    writer.count(fields);
    for (std::size_t i = 0; i < fields; ++i) {
        writeSimpleOperand(writer);
    }
    writeContentFilter(writer, known);
}

void writeDataChangeFilter(Writer& writer) {
    writer.number(static_cast<std::uint32_t>(writer.random().below(4)));
    writer.number(static_cast<std::uint32_t>(writer.random().below(4)));
    writer.real(1.0);
}

void writeAggregateFilter(Writer& writer) {
    writer.time();
    writer.id(standardId(2342));
    writer.real(1'000);
    for (int i = 0; i < 5; ++i) {
        writer.boolean(true);
    }
}

}  // namespace

void writeContentFilter(Writer& writer, const Known& known) {
    auto& random = writer.random();
    const auto elements = random.oneIn(3) ? random.below(random.oneIn(20) ? 200 : 6) : 0;
    writer.count(elements);
    for (std::size_t i = 0; i < elements; ++i) {
        writer.number(static_cast<std::uint32_t>(random.below(kOperators)));
        const auto operands = random.below(4);
        writer.count(operands);
        for (std::size_t operand = 0; operand < operands; ++operand) {
            writeOperand(writer, known, elements);
        }
    }
}

void writeFilter(Writer& writer, const Known& known) {
    constexpr std::uint32_t data_change = 724;
    constexpr std::uint32_t event = 727;
    constexpr std::uint32_t aggregate = 730;
    Writer body = writer.fresh();
    switch (writer.random().below(6)) {
        case 0:
            writer.id(standardId(0));
            return writer.exactly(std::uint8_t{0});
        case 1:
            writeDataChangeFilter(body);
            return writer.extension(data_change, body.bytes());
        case 2:
            writeAggregateFilter(body);
            return writer.extension(aggregate, body.bytes());
        default:
            writeEventFilter(body, known);
            return writer.extension(event, body.bytes());
    }
}

}  // namespace metier::hostile
