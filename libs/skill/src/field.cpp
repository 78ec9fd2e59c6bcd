#include "metier/skill/field.hpp"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>
#include <vector>

namespace metier::skill {

namespace {

/// "7.5 rad/s", or "7.5" for a unit without symbol.
std::string withUnit(double value, const Unit& unit) {
    return unit.symbol.empty() ? fmt::format("{}", value)
                               : fmt::format("{} {}", value, unit.symbol);
}

/// Checks the parts of one value against what its field allows.
class Checker {
public:
    explicit Checker(const Field& field) : field_(field) {}

    Result<void> operator()(std::monostate /*null*/) const { return {}; }
    Result<void> operator()(bool /*any*/) const { return {}; }
    Result<void> operator()(const std::string& text) const { return length(text.size()); }

    template <typename T>
    requires std::is_arithmetic_v<T> Result<void>
    operator()(T value) const { return number(static_cast<double>(value), ""); }
    Result<void> operator()(const Vector3& v) const {
        return allOf({{v.x, ".x"}, {v.y, ".y"}, {v.z, ".z"}}, "");
    }
    Result<void> operator()(const Frame& frame) const { return finiteFrame(frame, ""); }

    template <typename T>
    Result<void> operator()(const std::vector<T>& values) const {
        METIER_TRY(length(values.size()));
        for (std::size_t i = 0; i < values.size(); ++i) {
            METIER_TRY(element(values[i], fmt::format("[{}]", i)));
        }
        return {};
    }

private:
    struct Part {
        double value;
        std::string_view name;
    };

    static Result<void> element(const std::string& /*text*/, const std::string& /*where*/) {
        return {};
    }
    Result<void> element(double value, const std::string& where) const {
        return number(value, where);
    }
    Result<void> element(const Frame& frame, const std::string& where) const {
        return finiteFrame(frame, where);
    }
    Result<void> element(const Range& range, const std::string& where) const {
        METIER_TRY(allOf({{range.low, ".low"}, {range.high, ".high"}}, where));
        if (range.low > range.high) {
            return refuse(where,
                          fmt::format("low {} is over high {}", withUnit(range.low, field_.unit),
                                      withUnit(range.high, field_.unit)));
        }
        return {};
    }

    Result<void> finiteFrame(const Frame& f, std::string_view where) const {
        for (const auto& part : {Part{f.x, ".x"}, Part{f.y, ".y"}, Part{f.z, ".z"}, Part{f.a, ".a"},
                                 Part{f.b, ".b"}, Part{f.c, ".c"}}) {
            if (!std::isfinite(part.value)) {
                return refuse(fmt::format("{}{}", where, part.name),
                              fmt::format("{} is not finite", part.value));
            }
        }
        return {};
    }

    Result<void> allOf(std::initializer_list<Part> parts, std::string_view where) const {
        for (const auto& part : parts) {
            METIER_TRY(number(part.value, fmt::format("{}{}", where, part.name)));
        }
        return {};
    }

    Result<void> number(double value, std::string_view where) const {
        const auto& range = field_.range;
        if (!std::isfinite(value)) {
            return refuse(where, fmt::format("{} is not finite", withUnit(value, field_.unit)));
        }
        if (range && (value > range->high || value < range->low)) {
            const bool over = value > range->high;
            return refuse(where,
                          fmt::format("{} is {} the limit {}", withUnit(value, field_.unit),
                                      over ? "over" : "under",
                                      withUnit(over ? range->high : range->low, field_.unit)));
        }
        return {};
    }

    Result<void> length(std::size_t size) const {
        const auto& limit = field_.length;
        if (limit && size < limit->least) {
            return refuse("", fmt::format("{} elements are fewer than {}", size, limit->least));
        }
        if (limit && size > limit->most) {
            return refuse("", fmt::format("{} elements are more than {}", size, limit->most));
        }
        return {};
    }

    Result<void> refuse(std::string_view where, std::string_view what) const {
        return fail(Errc::out_of_range, fmt::format("{}{}: {}", field_.name, where, what));
    }

    const Field& field_;
};

}  // namespace

Result<void> checkValue(const Field& field, const Value& value) {
    if (isNull(value)) {
        return {};
    }
    if (typeOf(value) != field.type) {
        return fail(Errc::type_mismatch,
                    fmt::format("{}: {} expected, {} given", field.name, toString(field.type),
                                toString(typeOf(value))));
    }
    METIER_TRY(std::visit(Checker(field), value));
    if (!field.extra_check) {
        return {};
    }
    return field.extra_check(value).map_error([&](Error error) {
        error.message = fmt::format("{}: {}", field.name, error.message);
        return error;
    });
}

Result<Value> valueOrDefault(const Field& field, const Value& value) {
    const Value& used = isNull(value) ? field.default_value : value;
    if (isNull(used) && !field.optional) {
        return fail(Errc::invalid_argument, fmt::format("{}: a value is needed", field.name));
    }
    return used;
}

}  // namespace metier::skill
