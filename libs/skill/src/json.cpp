#include "metier/skill/json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <type_traits>
#include <variant>

namespace metier::skill {
namespace {

constexpr unsigned char kFirstPrintable = 0x20;

/// Appends to a buffer; one overload for each alternative of Value.
class JsonWriter {
public:
    std::string take() { return fmt::to_string(buffer_); }

    void operator()(std::monostate /*null*/) { raw("null"); }
    void operator()(bool value) { raw(value ? "true" : "false"); }
    void operator()(double value) {
        if (std::isfinite(value)) {
            fmt::format_to(std::back_inserter(buffer_), "{}", value);
        } else {
            raw("null");
        }
    }
    template <typename Integer>
    requires std::is_integral_v<Integer>
    void operator()(Integer value) { fmt::format_to(std::back_inserter(buffer_), "{}", value); }
    void operator()(const std::string& text) { quoted(text); }
    void operator()(const Frame& f) {
        number("{\"x\":", f.x);
        number(",\"y\":", f.y);
        number(",\"z\":", f.z);
        number(",\"a\":", f.a);
        number(",\"b\":", f.b);
        number(",\"c\":", f.c);
        raw("}");
    }
    void operator()(const Vector3& v) {
        number("{\"x\":", v.x);
        number(",\"y\":", v.y);
        number(",\"z\":", v.z);
        raw("}");
    }
    void operator()(const Range& range) {
        number("{\"low\":", range.low);
        number(",\"high\":", range.high);
        raw("}");
    }
    template <typename T>
    void operator()(const std::vector<T>& list) {
        raw("[");
        const char* between = "";
        for (const auto& element : list) {
            raw(between);
            (*this)(element);
            between = ",";
        }
        raw("]");
    }
    void operator()(const ValueMap& values) {
        raw("{");
        const char* between = "";
        for (const auto& [name, value] : values) {
            raw(between);
            quoted(name);
            raw(":");
            std::visit([this](const auto& one) { (*this)(one); }, value);
            between = ",";
        }
        raw("}");
    }

    void quoted(std::string_view text) {
        raw("\"");
        for (const char letter : text) {
            if (letter == '"' || letter == '\\') {
                buffer_.push_back('\\');
                buffer_.push_back(letter);
            } else if (static_cast<unsigned char>(letter) < kFirstPrintable) {
                fmt::format_to(std::back_inserter(buffer_), "\\u{:04x}",
                               static_cast<unsigned>(letter));
            } else {
                buffer_.push_back(letter);
            }
        }
        raw("\"");
    }

private:
    void raw(std::string_view text) { buffer_.append(text.data(), text.data() + text.size()); }
    void number(std::string_view before, double value) {
        raw(before);
        (*this)(value);
    }

    fmt::memory_buffer buffer_;
};

}  // namespace

std::string jsonOf(const Value& value) {
    JsonWriter writer;
    std::visit([&](const auto& one) { writer(one); }, value);
    return writer.take();
}

std::string jsonOf(const ValueMap& values) {
    JsonWriter writer;
    writer(values);
    return writer.take();
}

std::string jsonText(std::string_view text) {
    JsonWriter writer;
    writer.quoted(text);
    return writer.take();
}

}  // namespace metier::skill
