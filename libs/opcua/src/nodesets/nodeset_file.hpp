#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// A model that another one stands on.
struct RequiredModel {
    std::string uri;
    pugi::xml_node element;  ///< for messages
};

/// A model that a NodeSet holds: the nodes of one namespace.
struct NodesetModel {
    std::string uri;
    std::string version;  ///< as the file spells it; may be empty
    pugi::xml_node element;
    std::vector<RequiredModel> required;
};

/// A NodeSet2.xml file (OPC 10000-6, Annex F) in memory, with the lines of its elements.
///
/// Threading: one thread.
class NodesetFile {
public:
    /// Reads and parses a file; waits for the disk.
    /// Errors: not_found (no such file), invalid_argument with "file:line: why" (no XML, no
    ///         NodeSet, larger than 256 MB).
    static Result<NodesetFile> load(const std::filesystem::path& path);
    /// The same from a text. \param name stands for the file in messages
    static Result<NodesetFile> parse(std::string_view text, std::string name);

    const std::string& name() const noexcept { return name_; }
    /// At least one; those of a file without `Models` are its first namespace, which requires its
    /// others.
    const std::vector<NodesetModel>& models() const noexcept { return models_; }
    /// Those of the indices 1, 2, ... in the file.
    const std::vector<std::string>& namespaces() const noexcept { return namespaces_; }
    /// The element UANodeSet; valid as long as this.
    pugi::xml_node root() const { return document_->document_element(); }
    /// Line of an element, counted from 1.
    std::size_t lineOf(const pugi::xml_node& element) const;
    /// "file:line: why", for an element of this file.
    std::string problem(const pugi::xml_node& element, std::string_view why) const;

private:
    explicit NodesetFile(std::string name);
    Result<> read(std::string_view text);
    void readModels();
    std::size_t lineAt(std::ptrdiff_t offset) const;

    std::string name_;
    std::unique_ptr<pugi::xml_document> document_;
    std::vector<std::ptrdiff_t> line_ends_;
    std::vector<std::string> namespaces_;
    std::vector<NodesetModel> models_;
};

/// Name of an element without the prefix of its namespace: "Double" of `uax:Double`.
std::string_view localName(const pugi::xml_node& element) noexcept;
/// The first child of that local name; empty if there is none.
pugi::xml_node childNamed(const pugi::xml_node& element, std::string_view name);
/// Text of an element without the blanks around it; valid as long as the file.
std::string_view textIn(const pugi::xml_node& element) noexcept;

}  // namespace metier::opcua
