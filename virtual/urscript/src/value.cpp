#include "metier/urscript/value.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace metier::urscript {
namespace {

std::size_t weightOf(const Value& value) {
    const List* list = value.get<List>();
    return list == nullptr ? 1 : 1 + list->weight();
}

std::size_t charactersOf(const Value& value) {
    const auto* text = value.get<std::string>();
    const List* list = value.get<List>();
    return text != nullptr ? text->size() : list != nullptr ? list->characters() : 0;
}

int depthOf(const Value& value) {
    const List* list = value.get<List>();
    return list == nullptr ? 0 : list->depth();
}

std::string joined(const std::vector<Value>& elements) {
    std::string text;
    for (const Value& element : elements) {
        text += (text.empty() ? "" : ", ") + element.text();
    }
    return text;
}

struct TextOf {
    std::string operator()(std::monostate) const { return "None"; }
    std::string operator()(bool value) const { return value ? "True" : "False"; }
    std::string operator()(std::int32_t value) const { return fmt::format("{}", value); }
    std::string operator()(double value) const { return fmt::format("{:.6g}", value); }
    std::string operator()(const std::string& value) const { return value; }
    std::string operator()(const List& value) const { return "[" + joined(value.elements()) + "]"; }
    std::string operator()(const Pose& value) const {
        return fmt::format("p[{:.6g}]", fmt::join(value.value, ", "));
    }
};

}  // namespace

List::List(std::vector<Value> elements)
    : elements_(std::make_shared<std::vector<Value>>(std::move(elements))) {
    for (const Value& element : *elements_) {
        weight_ += weightOf(element);
        characters_ += charactersOf(element);
        depth_ = std::max(depth_, 1 + depthOf(element));
    }
}

const std::vector<Value>& List::elements() const {
    static const std::vector<Value> kNone;
    return elements_ ? *elements_ : kNone;
}

void List::set(std::size_t index, Value value) {
    if (elements_.use_count() > 1) {
        elements_ = std::make_shared<std::vector<Value>>(*elements_);
    }
    Value& element = (*elements_)[index];
    weight_ += weightOf(value) - weightOf(element);
    characters_ += charactersOf(value) - charactersOf(element);
    depth_ = std::max(depth_, 1 + depthOf(value));
    element = std::move(value);
}

Value::Value(const Vector6& numbers)
    : data_(List(std::vector<Value>(numbers.begin(), numbers.end()))) {}

double Value::number() const {
    if (const auto* integer = get<std::int32_t>()) {
        return *integer;
    }
    const auto* number = get<double>();
    return number == nullptr ? 0.0 : *number;
}

std::string_view Value::typeName() const {
    constexpr std::array<std::string_view, std::variant_size_v<Data>> kNames{
        "none", "bool", "int", "float", "string", "list", "pose"};
    return kNames[data_.index()];
}

std::string Value::text() const {
    return std::visit(TextOf{}, data_);
}

}  // namespace metier::urscript
