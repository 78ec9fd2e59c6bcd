#include "nodesets/nodeset_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include "metier/base/text.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

constexpr std::uintmax_t kLargestFile = 256'000'000;  // byte

}  // namespace

std::string_view localName(const pugi::xml_node& element) noexcept {
    const std::string_view name = element.name();
    const auto colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node childNamed(const pugi::xml_node& element, std::string_view name) {
    return element.find_child([name](const pugi::xml_node& child) {
        return child.type() == pugi::node_element && localName(child) == name;
    });
}

std::string_view textIn(const pugi::xml_node& element) noexcept {
    return trimmed(element.child_value());
}

NodesetFile::NodesetFile(std::string name)
    : name_(std::move(name)), document_(std::make_unique<pugi::xml_document>()) {}

Result<NodesetFile> NodesetFile::load(const std::filesystem::path& path) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (error) {
        return fail(Errc::not_found, fmt::format("{}: {}", path.string(), error.message()));
    }
    if (size > kLargestFile) {
        return fail(Errc::invalid_argument, fmt::format("{}: {} byte, over the limit of {} byte",
                                                        path.string(), size, kLargestFile));
    }
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (!file) {
        return fail(Errc::not_found, fmt::format("{}: cannot be read", path.string()));
    }
    return parse(text, path.string());
}

Result<NodesetFile> NodesetFile::parse(std::string_view text, std::string name) {
    NodesetFile file(std::move(name));
    METIER_TRY(file.read(text));
    return file;
}

Result<> NodesetFile::read(std::string_view text) {
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string_view::npos; ++at) {
        line_ends_.push_back(static_cast<std::ptrdiff_t>(at));
    }
    const auto parsed = document_->load_buffer(text.data(), text.size());
    if (!parsed) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}:{}: {}", name_, lineAt(parsed.offset), parsed.description()));
    }
    if (localName(root()) != "UANodeSet") {
        return fail(Errc::invalid_argument,
                    problem(root(), fmt::format("not a NodeSet: the element is {}, not UANodeSet",
                                                sanitise(root().name()))));
    }
    for (const auto& uri : childNamed(root(), "NamespaceUris").children()) {
        namespaces_.emplace_back(textIn(uri));
    }
    readModels();
    return models_.empty() ? fail(Errc::invalid_argument,
                                  problem(root(), "neither Models nor NamespaceUris name a model"))
                           : Result<>();
}

void NodesetFile::readModels() {
    for (const auto& element : childNamed(root(), "Models").children()) {
        NodesetModel model{element.attribute("ModelUri").value(),
                           element.attribute("Version").value(),
                           element,
                           {}};
        for (const auto& required : element.children()) {
            if (localName(required) == "RequiredModel") {
                model.required.push_back({required.attribute("ModelUri").value(), required});
            }
        }
        models_.push_back(std::move(model));
    }
    if (!models_.empty() || namespaces_.empty()) {
        return;
    }
    NodesetModel model{namespaces_.front(), "", childNamed(root(), "NamespaceUris"), {}};
    for (auto uri = std::next(namespaces_.begin()); uri != namespaces_.end(); ++uri) {
        model.required.push_back({*uri, model.element});
    }
    models_.push_back(std::move(model));
}

std::size_t NodesetFile::lineAt(std::ptrdiff_t offset) const {
    const auto end = std::lower_bound(line_ends_.begin(), line_ends_.end(), offset);
    return static_cast<std::size_t>(end - line_ends_.begin()) + 1;
}

std::size_t NodesetFile::lineOf(const pugi::xml_node& element) const {
    return lineAt(element.offset_debug());
}

std::string NodesetFile::problem(const pugi::xml_node& element, std::string_view why) const {
    return fmt::format("{}:{}: {}", name_, lineOf(element), why);
}

}  // namespace metier::opcua
