#include "call.hpp"

namespace metier::urscript {
namespace {

Value textMessage(Call& call) {
    call.robot().textMessage(call.value(0).text() + (call.given(1) ? call.value(1).text() : ""));
    return {};
}

Value popup(Call& call) {
    Popup popup;
    popup.text = call.value(0).text();
    popup.title = call.string(1, "Popup");
    popup.level = call.boolean(2, false) ? Popup::Level::warning : popup.level;
    popup.level = call.boolean(3, false) ? Popup::Level::error : popup.level;
    popup.blocking = call.boolean(4, false);
    if (!call.ok()) {
        return {};
    }
    call.robot().showPopup(popup);
    if (!popup.blocking) {
        return {};
    }
    return call.waits([&robot = call.robot()] {
        return Result<std::optional<Value>>(robot.popupOpen() ? std::optional<Value>() : Value());
    });
}

}  // namespace

std::span<const Builtin> programBuiltins() {
    static constexpr Builtin kAll[] = {
        {"get_steptime", "", 0, [](Call& call) { return Value(call.robot().stepTime()); }},
        {"popup", "s title warning error blocking", 1, popup},
        {"sleep", "t", 1, [](Call& call) { return call.sleeps(call.number(0)); }},
        {"sync", "", 0, [](Call& call) { return call.sleeps(0.0); }},
        {"textmsg", "s1 s2", 1, textMessage},
        {"time", "", 0, [](Call& call) { return Value(call.robot().state().time); }},
    };
    return kAll;
}

}  // namespace metier::urscript
