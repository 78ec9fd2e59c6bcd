// The smallest server of a skill: a lamp, and a skill that switches it on or off.
#include <iostream>

#include "metier/server/own_server.hpp"

using namespace metier;

int main(int argc, char** argv) {
    bool lit = false;
    server::OwnServer lamp(argc, argv, {.name = "lamp", .description = "A lamp.", .port = 48491});
    lamp.offer({.name = "ToggleLampSkill",
                .type = "ToggleLampSkillType",
                .description = "Switches the lamp on if it is off, and off if it is on.",
                .results = {{.name = "Lit",
                             .type = skill::ValueType::boolean,
                             .place = skill::Place::final_result}}},
               {.start = [&lit](const skill::ValueMap&, const skill::ExecutionHandle& execution) {
                   lit = !lit;
                   std::cout << "the lamp is " << (lit ? "on" : "off") << "\n" << std::flush;
                   execution.finish({{"Lit", lit}});
               }});
    return lamp.run();
}
