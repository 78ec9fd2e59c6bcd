#include "responses.hpp"

#include <array>

#include "known.hpp"
#include "odd_values.hpp"

namespace metier::hostile {

namespace {

constexpr std::string_view kNone = "http://opcfoundation.org/UA/SecurityPolicy#None";
constexpr std::string_view kTransport =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
/// Names that a client of skills looks for.
constexpr std::array<std::string_view, 26> kNames{
    "Start",        "Suspend",      "Resume",        "Halt",       "Reset",
    "CurrentState", "Number",       "ParameterSet",  "Options",    "FinalResultData",
    "ReasonText",   "ExecutionId",  "StartWith",     "Check",      "GetExecution",
    "Skills",       "Controllers",  "MotionDevices", "Kinematics", "ActualJointPosition",
    "SafetyState",  "MissedCycles", "JointFrames",   "EURange",    "EngineeringUnits",
    "Velocity"};
constexpr std::array<std::uint32_t, 6> kTypes{2391, 58, 61, 7'001, 7'002, 7'003};

AddressMap someNodes() {
    AddressMap map;
    for (std::uint32_t i = 0; i < 12; ++i) {
        map.nodes.push_back(numericId(1, 7'000 + i));
    }
    map.variables = map.nodes;
    return map;
}

const Known& known() {
    static const AddressMap made_up_map = someNodes();
    static const Known made_up{.map = made_up_map, .endpoint_url = {}};
    return made_up;
}

void writeHeader(Writer& writer, std::uint32_t type, const Asked& asked, std::uint32_t status = 0) {
    writer.id(standardId(type));
    writer.time();
    writer.number(asked.handle);
    writer.number(status);
    if (writer.isWrong()) {
        writeDiagnostic(writer);
    } else {
        writer.exactly(std::uint8_t{0});
    }
    writer.count(0);
    writer.raw(Bytes(3, '\0'));
}

void writeApplication(Writer& writer, std::string_view url) {
    writer.text("urn:hostile:server");
    writer.noText();
    writer.localizedText("\xff\x1b[31mserver");
    writer.number(std::uint32_t{0});
    writer.noText();
    writer.noText();
    writer.count(1);
    writer.text(url);
}

void writeEndpoints(Writer& writer, const std::string& url) {
    const std::string_view elsewhere = "opc.tcp://127.0.0.1:1";
    const auto endpoints = writer.random().oneIn(20) ? 300 : 1 + writer.random().below(2);
    writer.count(endpoints);
    for (std::size_t i = 0; i < endpoints; ++i) {
        writer.text(writer.isWrong() ? elsewhere : url);
        writeApplication(writer, url);
        writer.noText();
        writer.number(std::uint32_t{1});
        writer.text(kNone);
        writer.count(1);
        writer.text("anonymous");
        writer.number(std::uint32_t{0});
        writer.noText();
        writer.noText();
        writer.noText();
        writer.text(kTransport);
        writer.number(std::uint8_t{0});
    }
}

void writeCreateSession(Writer& writer, const std::string& url) {
    writer.id(numericId(1, 100));
    writer.id(numericId(1, 101));
    writer.real(30'000);
    writer.text(Bytes(32, 'n'));
    writer.noText();
    writeEndpoints(writer, url);
    writer.count(0);
    writer.noText();
    writer.noText();
    writer.number(std::uint32_t{0});
}

void writeReference(Writer& writer, Landscape landscape) {
    auto& random = writer.random();
    const bool is_new = landscape == Landscape::endless && !random.oneIn(3);
    writer.id(standardId(random.oneIn(3) ? 45 : 47));
    writer.boolean(true);
    writer.expandedId(is_new ? numericId(1, static_cast<std::uint32_t>(random.next()))
                             : numericId(1, 7'000 + static_cast<std::uint32_t>(random.below(12))));
    writer.qualifiedName(random.oneIn(2) ? 0 : 1, random.pick(kNames));
    writer.localizedText("\xc3(");
    constexpr std::array<std::uint32_t, 3> classes{1, 2, 4};
    writer.number(landscape == Landscape::endless ? 1U : random.pick(classes));
    constexpr std::uint32_t base_object = 58;
    writer.expandedId(landscape == Landscape::endless
                          ? standardId(base_object)
                          : numericId(random.oneIn(2) ? 0 : 1, random.pick(kTypes)));
}

std::size_t referencesIn(Random& random, Landscape landscape) {
    switch (landscape) {
        case Landscape::loops:
            return random.below(30);
        case Landscape::endless:
            return 4;
        case Landscape::plenty:
            break;
    }
    return 3'000;
}

void writeBrowse(Writer& writer, std::uint32_t items, Landscape landscape) {
    writer.count(items);
    for (std::uint32_t i = 0; i < items; ++i) {
        writer.number(std::uint32_t{0});
        const bool goes_on = landscape == Landscape::plenty || writer.isWrong();
        writer.text(goes_on ? "continued" : "");
        const auto references = referencesIn(writer.random(), landscape);
        writer.count(references);
        for (std::size_t reference = 0; reference < references; ++reference) {
            writeReference(writer, landscape);
        }
    }
    writer.count(0);
}

void writeRead(Writer& writer, std::uint32_t items, Landscape landscape) {
    constexpr std::uint8_t value = 1;
    constexpr std::uint8_t doubles = 0x8B;
    writer.count(items);
    for (std::uint32_t i = 0; i < items; ++i) {
        if (landscape == Landscape::loops) {
            writeDataValue(writer, known());
            continue;
        }
        constexpr std::size_t many_elements = 2'000;
        writer.exactly(value);
        writer.exactly(doubles);
        writer.count(many_elements);
        writer.raw(Bytes(many_elements * sizeof(double), '\x40'));
    }
    writer.count(0);
}

void writeTranslate(Writer& writer, std::uint32_t items) {
    writer.count(items);
    for (std::uint32_t i = 0; i < items; ++i) {
        writer.number(std::uint32_t{0});
        const auto targets = writer.random().below(3);
        writer.count(targets);
        for (std::size_t target = 0; target < targets; ++target) {
            writer.expandedId(anyNode(writer.random(), known()));
            writer.number(std::uint32_t{0xFFFF'FFFF});
        }
    }
    writer.count(0);
}

void writeCall(Writer& writer, std::uint32_t items) {
    writer.count(items);
    for (std::uint32_t i = 0; i < items; ++i) {
        writer.number(std::uint32_t{0});
        writer.count(0);
        writer.count(0);
        const auto outputs = writer.random().below(6);
        writer.count(outputs);
        for (std::size_t output = 0; output < outputs; ++output) {
            writeVariant(writer, known());
        }
    }
    writer.count(0);
}

void writeStatuses(Writer& writer, std::uint32_t items) {
    writer.count(items);
    for (std::uint32_t i = 0; i < items; ++i) {
        writer.number(std::uint32_t{0});
    }
    writer.count(0);
}

void writeSubscription(Writer& writer) {
    writer.number(std::uint32_t{1});
    writer.real(50);
    writer.number(std::uint32_t{100});
    writer.number(std::uint32_t{10});
}

void writeItems(Writer& writer, std::uint32_t items) {
    writer.count(items);
    for (std::uint32_t i = 0; i < items; ++i) {
        writer.number(std::uint32_t{0});
        writer.number(i + 1);
        writer.real(50);
        writer.number(std::uint32_t{10});
        writer.raw(Bytes(3, '\0'));
    }
    writer.count(0);
}

void writeEvents(Writer& body) {
    const auto events = body.random().below(4);
    body.count(events);
    for (std::size_t i = 0; i < events; ++i) {
        body.number(std::uint32_t{1});
        const auto fields = body.random().below(25);
        body.count(fields);
        for (std::size_t field = 0; field < fields; ++field) {
            writeVariant(body, known());
        }
    }
}

void writePublish(Writer& writer) {
    constexpr std::uint32_t data_change = 811;
    constexpr std::uint32_t events_id = 916;
    writer.number(std::uint32_t{1});
    writer.count(0);
    writer.boolean(writer.random().oneIn(3));
    writer.number(static_cast<std::uint32_t>(1 + writer.random().below(20)));
    writer.time();
    writer.count(1);
    Writer body = writer.fresh();
    const bool events = writer.random().oneIn(2);
    if (events) {
        writeEvents(body);
    } else {
        body.count(1);
        body.number(std::uint32_t{1});
        writeDataValue(body, known());
        body.count(0);
    }
    writer.extension(events ? events_id : data_change, body.bytes());
    writer.count(0);
    writer.count(0);
}

void writeServers(Writer& writer, const std::string& url) {
    const auto servers = writer.random().oneIn(10) ? 2'000 : 2;
    writer.count(static_cast<std::size_t>(servers));
    for (int i = 0; i < servers; ++i) {
        writeApplication(writer, url);
    }
}

}  // namespace

Bytes respondOpen(Writer writer, const Asked& asked) {
    constexpr std::uint32_t response = 449;
    writeHeader(writer, response, asked);
    writer.number(std::uint32_t{0});
    writer.number(std::uint32_t{1});
    writer.number(std::uint32_t{1});
    writer.time();
    writer.number(std::uint32_t{600'000});
    writer.text("n");
    return writer.take();
}

Bytes serviceFault(Writer writer, const Asked& asked, std::uint32_t status) {
    constexpr std::uint32_t fault = 397;
    writeHeader(writer, fault, asked, status);
    return writer.take();
}

// One case for each service.
Bytes respond(Writer writer, const Asked& asked, const std::string& url, Landscape landscape) {
    constexpr std::uint32_t to_response = 3;
    writeHeader(writer, asked.type + to_response, asked);
    switch (asked.type) {
        case 422:
            writeServers(writer, url);
            break;
        case 428:
            writeEndpoints(writer, url);
            break;
        case 461:
            writeCreateSession(writer, url);
            break;
        case 467:
            writer.text(Bytes(32, 'n'));
            writer.count(0);
            writer.count(0);
            break;
        case 527:
        case 533:
            writeBrowse(writer, asked.items, landscape);
            break;
        case 554:
            writeTranslate(writer, asked.items);
            break;
        case 631:
            writeRead(writer, asked.items, landscape);
            break;
        case 712:
            writeCall(writer, asked.items);
            break;
        case 751:
            writeItems(writer, asked.items);
            break;
        case 787:
            writeSubscription(writer);
            break;
        case 826:
            writePublish(writer);
            break;
        default:
            writeStatuses(writer, asked.items);
    }
    return writer.take();
}

}  // namespace metier::hostile
