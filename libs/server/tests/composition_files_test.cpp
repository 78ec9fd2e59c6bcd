#include "kinds/compositions.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "lab.hpp"

namespace metier::server::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class CompositionFiles : public ::testing::Test {
protected:
    ~CompositionFiles() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& uses) const {
        const auto file = folder_ / (name + ".toml");
        std::ofstream(file) << "name = \"" << name << "Skill\"\n[uses.one]\ntype = \"" << uses
                            << "\"\n[[step]]\nname = \"run\"\nrun = \"one\"\n";
        return file;
    }

    const std::filesystem::path folder_ = freshFolder();
};

TEST_F(CompositionFiles, ComeAfterThoseThatTheyUse) {
    const auto loaded =
        loadDefinitions({write("Top", "MiddleSkillType"), write("Middle", "BottomSkillType"),
                         write("Bottom", "JointPtpMoveSkillType")});
    ASSERT_TRUE(loaded) << loaded.error().message;
    std::vector<std::string> names;
    for (const auto& definition : *loaded) {
        names.push_back(definition.name);
    }
    EXPECT_THAT(names, ElementsAre("BottomSkill", "MiddleSkill", "TopSkill"));
}

TEST_F(CompositionFiles, AreRefusedTogetherWithEverythingThatIsWrong) {
    const auto good = write("Good", "JointPtpMoveSkillType");
    const auto bad = folder_ / "Bad.toml";
    std::ofstream(bad) << "name = 1\n";
    const auto missing = folder_ / "missing.toml";
    const auto loaded = loadDefinitions({bad, good, missing});
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().code, Errc::invalid_argument);
    EXPECT_THAT(loaded.error().message, AllOf(HasSubstr("Bad.toml"), HasSubstr("missing.toml")));
    EXPECT_THAT(loaded.error().message, ::testing::Not(HasSubstr("Good.toml")));
}

TEST_F(CompositionFiles, AreRefusedInACircle) {
    EXPECT_FALSE(loadDefinitions({write("One", "TwoSkillType"), write("Two", "OneSkillType")}));
}

TEST(Lives, OfAServerAreToldApart) {
    EXPECT_THAT(newLife(), MatchesRegex("[0-9a-f]+"));
    EXPECT_EQ(newLife().size(), 6U);
    EXPECT_NE(newLife() + newLife(), newLife() + newLife());
}

}  // namespace
}  // namespace metier::server::testing
