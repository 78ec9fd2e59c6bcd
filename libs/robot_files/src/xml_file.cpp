#include "xml_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "metier/base/text.hpp"
#include "metier/motion/frame.hpp"

namespace metier::robot_files {

namespace {

constexpr std::size_t kLargest = std::size_t{16} << 20U;  // [bytes]
constexpr std::size_t kLongestShown = 40;
constexpr std::size_t kMostErrors = 100;
constexpr double kFarthest = 1e4;

std::vector<std::size_t> lineStarts(std::string_view text) {
    std::vector<std::size_t> starts{0};
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\n') {
            starts.push_back(i + 1);
        }
    }
    return starts;
}

std::size_t lineAt(const std::vector<std::size_t>& starts, std::ptrdiff_t offset) {
    const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0));
    return static_cast<std::size_t>(std::upper_bound(starts.begin(), starts.end(), at) -
                                    starts.begin());
}

/// The first element that xacro would expand.
pugi::xml_node xacroElement(const pugi::xml_document& document) {
    return document.find_node([](const pugi::xml_node& node) {
        return std::string_view(node.name()).starts_with("xacro:");
    });
}

/// A name that is part of a file's name or of a message, without the rest of a long one.
std::string shown(std::string_view text) {
    return std::string(text.substr(0, kLongestShown)) + (text.size() > kLongestShown ? "..." : "");
}

/// The command that expands a file; it never writes over it.
std::string expanded(std::string_view name) {
    const auto slash = name.rfind('/');
    const auto stem = name.substr(slash == std::string_view::npos ? 0 : slash + 1);
    return fmt::format("it is an xacro file; this expands it: xacro {} > {}{}.urdf", name,
                       stem.substr(0, stem.find('.')), name.ends_with(".xacro") ? "" : "_expanded");
}

/// Whether each number is small enough to be computed with: [m] or [rad].
bool areNear(const std::vector<double>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(),
                       [](double number) { return std::abs(number) <= kFarthest; });
}

/// The nearest multiple of 15 degrees if it is within 1e-4 rad.
double roundedAngle(double angle) {
    constexpr double step = std::numbers::pi / 12;
    constexpr double near = 1e-4;
    const double round = step * std::round(angle / step);
    return std::abs(angle - round) < near ? round : angle;
}

}  // namespace

std::optional<std::vector<double>> numbersIn(std::string_view text) {
    std::vector<double> numbers;
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
        auto word = text.substr(0, text.find_first_of(kBlanks));
        text.remove_prefix(word.size());
        word.remove_prefix(word.starts_with('+') ? 1 : 0);
        const auto number = numberIn<double>(word);
        if (!number || !std::isfinite(*number)) {
            return std::nullopt;
        }
        numbers.push_back(*number);
    }
    return numbers;
}

Result<XmlFile> XmlFile::parse(std::string_view text, std::string name) {
    if (text.size() > kLargest) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: {} bytes, at most {}", name, text.size(), kLargest));
    }
    XmlFile file;
    file.name_ = std::move(name);
    file.line_starts_ = lineStarts(text);
    const auto parsed = file.document_.load_buffer(text.data(), text.size(), pugi::parse_default,
                                                   pugi::encoding_utf8);
    const auto xacro = xacroElement(file.document_);
    if (file.name_.ends_with(".xacro") || xacro) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}:{}: {}", file.name_, xacro ? file.line(xacro) : 1,
                                expanded(file.name_)));
    }
    if (!parsed) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}:{}: no XML: {}", file.name_,
                                lineAt(file.line_starts_, parsed.offset), parsed.description()));
    }
    if (!isUtf8(text)) {
        return fail(Errc::invalid_argument, fmt::format("{}: not UTF-8", file.name_));
    }
    return file;
}

std::size_t XmlFile::line(pugi::xml_node element) const {
    return lineAt(line_starts_, element.offset_debug());
}

std::string XmlFile::place(pugi::xml_node element) const {
    const std::string_view name = element.attribute("name").value();
    return fmt::format("{}:{}: <{}{}>", name_, line(element), shown(element.name()),
                       name.empty() ? "" : fmt::format(" name=\"{}\"", shown(name)));
}

void XmlFile::note(pugi::xml_node element, std::string_view why) {
    auto text = fmt::format("{}: {}", place(element), why);
    const bool known = std::any_of(errors_.begin(), errors_.end(),
                                   [&](const Noted& noted) { return noted.text == text; });
    if (!known && errors_.size() < kMostErrors) {
        errors_.push_back({line(element), std::move(text)});
    }
}

Result<void> XmlFile::finish() const {
    if (errors_.empty()) {
        return {};
    }
    auto errors = errors_;
    std::stable_sort(errors.begin(), errors.end(),
                     [](const Noted& a, const Noted& b) { return a.line < b.line; });
    std::vector<std::string> texts;
    for (const auto& error : errors) {
        texts.push_back(error.text);
    }
    return fail(Errc::invalid_argument, fmt::format("{}", fmt::join(texts, "\n")));
}

std::string XmlFile::text(pugi::xml_node element, const char* attribute) {
    std::string value = element.attribute(attribute).value();
    if (value.empty()) {
        note(element, fmt::format("no {}", attribute));
    }
    return value;
}

std::optional<double> XmlFile::number(pugi::xml_node element, const char* attribute) {
    const auto given = element.attribute(attribute);
    if (!given) {
        return std::nullopt;
    }
    const auto numbers = numbersIn(given.value());
    if (!numbers || numbers->size() != 1) {
        note(element,
             fmt::format("{}=\"{}\" is no finite number", attribute, shown(given.value())));
        return std::nullopt;
    }
    return numbers->front();
}

Eigen::Vector3d XmlFile::vector(pugi::xml_node element, const char* attribute,
                                const Eigen::Vector3d& otherwise) {
    const auto given = element.attribute(attribute);
    if (!given) {
        return otherwise;
    }
    const auto numbers = numbersIn(given.value());
    if (!numbers || numbers->size() != 3 || !areNear(*numbers)) {
        note(element, fmt::format("{}=\"{}\" is not three numbers of at most {}", attribute,
                                  shown(given.value()), kFarthest));
        return otherwise;
    }
    return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

motion::Pose XmlFile::origin(pugi::xml_node element, bool round_angles) {
    const auto origin = element.child("origin");
    const auto xyz = vector(origin, "xyz", Eigen::Vector3d::Zero());
    auto rpy = vector(origin, "rpy", Eigen::Vector3d::Zero());
    if (round_angles) {
        rpy = rpy.unaryExpr(&roundedAngle);
    }
    return motion::toPose({xyz.x(), xyz.y(), xyz.z(), rpy.x(), rpy.y(), rpy.z()});
}

}  // namespace metier::robot_files
