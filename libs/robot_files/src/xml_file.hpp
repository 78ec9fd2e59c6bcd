#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/pose.hpp"

namespace metier::robot_files {

/// Numbers that the text spells, with blanks between them; nothing if a word is no finite number.
std::optional<std::vector<double>> numbersIn(std::string_view text);

/// An XML file that is read element by element. Reading never fails at once: an error is noted with
/// file, line and element, and a harmless value is returned; finish() reports all errors together.
///
/// Threading: one thread.
class XmlFile {
public:
    /// \param name stands for the file in messages
    /// Errors: invalid_argument (no XML, larger than 16 MiB, an xacro file), with the line.
    static Result<XmlFile> parse(std::string_view text, std::string name);

    const std::string& name() const noexcept { return name_; }
    /// The outermost element.
    pugi::xml_node root() const { return document_.document_element(); }
    /// Line of an element, counted from 1.
    std::size_t line(pugi::xml_node element) const;
    /// "file:line: <joint name="elbow">"
    std::string place(pugi::xml_node element) const;

    /// Notes an error of an element, once; after 100 errors no more are kept.
    void note(pugi::xml_node element, std::string_view why);
    /// Whether anything was noted.
    bool hasErrors() const noexcept { return !errors_.empty(); }
    /// Errors: invalid_argument with a line for each error, in the order of the file.
    Result<void> finish() const;

    /// A required attribute that is not empty; "" if an error was noted.
    std::string text(pugi::xml_node element, const char* attribute);
    /// A finite number; nothing if there is no such attribute.
    std::optional<double> number(pugi::xml_node element, const char* attribute);
    /// Three numbers of at most 1e4, or `otherwise` if there is no such attribute.
    Eigen::Vector3d vector(pugi::xml_node element, const char* attribute,
                           const Eigen::Vector3d& otherwise);
    /// The element's `origin`: xyz [m] and rpy [rad]; the identity if it has none.
    /// \param round_angles takes angles within 1e-4 rad of a multiple of 15 degrees for that
    motion::Pose origin(pugi::xml_node element, bool round_angles = false);

private:
    struct Noted {
        std::size_t line;
        std::string text;
    };

    std::string name_;
    pugi::xml_document document_;
    std::vector<std::size_t> line_starts_;  // offsets
    std::vector<Noted> errors_;
};

}  // namespace metier::robot_files
