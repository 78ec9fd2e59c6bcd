// The View, NodeManagement and Query services.
#include <array>

#include "filters.hpp"
#include "odd_values.hpp"
#include "requests.hpp"

namespace metier::hostile {

namespace {

constexpr std::uint32_t kReferences = 31;
constexpr std::uint32_t kHierarchical = 33;
constexpr std::uint32_t kOrganizes = 35;
constexpr std::uint32_t kObjectAttributes = 354;
constexpr std::uint32_t kVariableAttributes = 357;

void writeView(Writer& writer) {
    writer.id(standardId(0));
    writer.time();
    writer.number(std::uint32_t{0});
}

void writeBrowse(Writer& writer, const Known& known) {
    auto& random = writer.random();
    writeView(writer);
    writer.number(static_cast<std::uint32_t>(random.below(4)));
    const auto nodes = random.below(random.oneIn(50) ? 300 : 5);
    writer.count(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        writer.id(anyNode(random, known));
        writer.number(static_cast<std::uint32_t>(random.below(4)));
        writer.id(standardId(random.oneIn(2) ? kReferences : kHierarchical));
        writer.boolean(true);
        writer.number(std::uint32_t{0});
        writer.number(std::uint32_t{63});
    }
}

void writeBrowseNext(Writer& writer, const Known& known) {
    writer.boolean(writer.random().oneIn(3));
    const auto points = writer.random().below(4);
    writer.count(points);
    for (std::size_t i = 0; i < points; ++i) {
        writer.text(known.continuation_point);
    }
}

void writeTranslate(Writer& writer, const Known& known) {
    auto& random = writer.random();
    const auto paths = random.below(random.oneIn(40) ? 300 : 4);
    writer.count(paths);
    for (std::size_t i = 0; i < paths; ++i) {
        writer.id(anyNode(random, known));
        const auto elements = random.below(random.oneIn(30) ? 8'000 : 4);
        writer.count(elements);
        for (std::size_t element = 0; element < elements; ++element) {
            writer.id(standardId(kHierarchical));
            writer.boolean(random.oneIn(4));
            writer.boolean(true);
            writer.qualifiedName(0, "CurrentState");
        }
    }
}

void writeNodeList(Writer& writer, const Known& known) {
    const auto nodes = writer.random().below(writer.random().oneIn(40) ? 1'200 : 6);
    writer.count(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        writer.id(anyNode(writer.random(), known));
    }
}

void writeNodeAttributes(Writer& writer, const Known& known, bool is_variable) {
    Writer body = writer.fresh();
    body.number(std::uint32_t{0});
    body.localizedText("added");
    body.localizedText("added");
    if (is_variable) {
        writeVariant(body, known);
        body.id(standardId(24));
        body.number(std::int32_t{-1});
        body.count(0);
        body.number(std::uint8_t{3});
        body.number(std::uint8_t{3});
        body.real(0);
        body.boolean(false);
    } else {
        body.number(std::uint8_t{1});
    }
    body.number(std::uint32_t{0});
    body.number(std::uint32_t{0});
    writer.extension(is_variable ? kVariableAttributes : kObjectAttributes, body.bytes());
}

void writeAddNodes(Writer& writer, const Known& known) {
    const auto nodes = writer.random().below(4);
    writer.count(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        const bool is_variable = writer.random().oneIn(2);
        writer.expandedId(anyNode(writer.random(), known));
        writer.id(standardId(kOrganizes));
        writer.expandedId(numericId(1, 0));
        writer.qualifiedName(1, "Added");
        writer.number(is_variable ? std::uint32_t{2} : std::uint32_t{1});
        writeNodeAttributes(writer, known, is_variable);
        writer.expandedId(standardId(is_variable ? 63 : 58));
    }
}

void writeAddReferences(Writer& writer, const Known& known) {
    const auto references = writer.random().below(4);
    writer.count(references);
    for (std::size_t i = 0; i < references; ++i) {
        writer.id(anyNode(writer.random(), known));
        writer.id(standardId(kOrganizes));
        writer.boolean(true);
        writer.noText();
        writer.expandedId(anyNode(writer.random(), known));
        writer.number(std::uint32_t{1});
    }
}

void writeDeleteNodes(Writer& writer, const Known& known) {
    const auto nodes = writer.random().below(5);
    writer.count(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        writer.id(anyNode(writer.random(), known));
        writer.boolean(true);
    }
}

void writeDeleteReferences(Writer& writer, const Known& known) {
    const auto references = writer.random().below(4);
    writer.count(references);
    for (std::size_t i = 0; i < references; ++i) {
        writer.id(anyNode(writer.random(), known));
        writer.id(standardId(kOrganizes));
        writer.boolean(true);
        writer.expandedId(anyNode(writer.random(), known));
        writer.boolean(true);
    }
}

void writeQueryFirst(Writer& writer, const Known& known) {
    writeView(writer);
    writer.count(1);
    writer.expandedId(standardId(58));
    writer.boolean(true);
    writer.count(1);
    writer.count(0);
    writer.number(std::uint32_t{13});
    writer.noText();
    writeContentFilter(writer, known);
    writer.number(std::uint32_t{100});
    writer.number(std::uint32_t{100});
}

void writeQueryNext(Writer& writer, const Known& known) {
    writer.boolean(false);
    writer.text(known.continuation_point);
}

}  // namespace

std::span<const Request> nodeRequests() {
    static constexpr std::array<Request, 11> all{{{527, writeBrowse, 10},
                                                  {533, writeBrowseNext, 4},
                                                  {554, writeTranslate, 6},
                                                  {560, writeNodeList, 2},
                                                  {566, writeNodeList, 2},
                                                  {488, writeAddNodes, 5},
                                                  {494, writeAddReferences, 3},
                                                  {500, writeDeleteNodes, 5},
                                                  {506, writeDeleteReferences, 3},
                                                  {615, writeQueryFirst, 2},
                                                  {621, writeQueryNext, 1}}};
    return all;
}

}  // namespace metier::hostile
