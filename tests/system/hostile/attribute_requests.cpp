// The Attribute, Method and History services.
#include <array>

#include "odd_values.hpp"
#include "requests.hpp"

namespace metier::hostile {

namespace {

std::uint32_t anyAttribute(Random& random) {
    return random.oneIn(3) ? static_cast<std::uint32_t>(random.below(30)) : kValueAttribute;
}

void writeRange(Writer& writer) {
    constexpr std::array<std::string_view, 7> ranges{"0",   "0:1", "1:0", "0:4294967295",
                                                     "0,0", "-1",  "a:b"};
    if (writer.random().oneIn(10)) {
        return writer.text(writer.random().pick(ranges));
    }
    writer.noText();
}

void writeReadItem(Writer& writer, const Known& known) {
    writer.id(writer.random().oneIn(2) ? anyVariable(writer.random(), known)
                                       : anyNode(writer.random(), known));
    writer.number(anyAttribute(writer.random()));
    writeRange(writer);
    if (writer.random().oneIn(20)) {
        return writer.qualifiedName(0, "Default JSON");
    }
    writer.exactly(std::uint16_t{0});
    writer.noText();
}

void writeRead(Writer& writer, const Known& known) {
    writer.real(0);
    writer.number(static_cast<std::uint32_t>(writer.random().below(4)));
    const auto items = writer.random().below(writer.random().oneIn(50) ? 1'100 : 10);
    writer.count(items);
    for (std::size_t i = 0; i < items; ++i) {
        writeReadItem(writer, known);
    }
}

void writeWrite(Writer& writer, const Known& known) {
    const auto items = writer.random().below(writer.random().oneIn(50) ? 220 : 5);
    writer.count(items);
    for (std::size_t i = 0; i < items; ++i) {
        writer.id(anyVariable(writer.random(), known));
        writer.number(anyAttribute(writer.random()));
        writeRange(writer);
        writeDataValue(writer, known);
    }
}

void writeCalls(Writer& writer, const Known& known) {
    auto& random = writer.random();
    const auto calls = random.below(random.oneIn(50) ? 15 : 3);
    writer.count(calls);
    for (std::size_t i = 0; i < calls; ++i) {
        const auto& called = random.pick(known.map.methods);
        writer.id(random.oneIn(10) ? anyNode(random, known) : called.object);
        writer.id(random.oneIn(10) ? anyNode(random, known) : called.method);
        const auto arguments = random.below(random.oneIn(30) ? 40 : 5);
        writer.count(arguments);
        for (std::size_t argument = 0; argument < arguments; ++argument) {
            writeVariant(writer, known);
        }
    }
}

void writeHistoryDetails(Writer& writer) {
    constexpr std::array<std::uint32_t, 5> details{646, 649, 652, 655, 681};
    Writer body = writer.fresh();
    body.boolean(false);
    body.time();
    body.time();
    body.number(std::uint32_t{10});
    body.boolean(false);
    writer.extension(writer.random().pick(details), body.bytes());
}

void writeHistoryRead(Writer& writer, const Known& known) {
    writeHistoryDetails(writer);
    writer.number(std::uint32_t{2});
    writer.boolean(writer.random().oneIn(4));
    const auto nodes = writer.random().below(4);
    writer.count(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        writer.id(anyVariable(writer.random(), known));
        writeRange(writer);
        writer.qualifiedName(0, "");
        writer.text(known.continuation_point);
    }
}

void writeHistoryUpdate(Writer& writer, const Known& known) {
    constexpr std::array<std::uint32_t, 4> details{682, 685, 688, 691};
    const auto updates = writer.random().below(3);
    writer.count(updates);
    for (std::size_t i = 0; i < updates; ++i) {
        Writer body = writer.fresh();
        body.id(anyVariable(body.random(), known));
        body.number(std::uint32_t{1});
        body.count(1);
        writeDataValue(body, known);
        writer.extension(writer.random().pick(details), body.bytes());
    }
}

}  // namespace

std::span<const Request> attributeRequests() {
    static constexpr std::array<Request, 5> all{{{631, writeRead, 14},
                                                 {673, writeWrite, 12},
                                                 {712, writeCalls, 20},
                                                 {664, writeHistoryRead, 3},
                                                 {700, writeHistoryUpdate, 2}}};
    return all;
}

}  // namespace metier::hostile
