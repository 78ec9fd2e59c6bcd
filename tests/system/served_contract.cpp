#include "served_contract.hpp"

#include <stdexcept>

namespace metier::system_tests {

namespace {

template <typename T>
T orThrow(opcua::Answer<T> answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    return std::move(*answer);
}

}  // namespace

opcua::Client& ServedContract::client() {
    if (!client_) {
        client_ = connect();
    }
    return *client_;
}

client::SkillHandle ServedContract::openSkill(opcua::Client& client, const std::string& name) {
    return orThrow(client::SkillHandle::open(client, orThrow(client::findSkill(client, name))));
}

client::SkillHandle ServedContract::openSkill(const std::string& name) {
    return openSkill(client(), name);
}

std::string ServedContract::textAt(const served::ServedSkill& skill, std::string_view path) {
    return served::readAs<opcua::LocalizedText>(client(), skill, path).text;
}

}  // namespace metier::system_tests
