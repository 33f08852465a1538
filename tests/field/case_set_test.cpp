#include "elrom/field/case_set.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "support/changed_members.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::field {
namespace {

const std::vector<std::size_t> rows{0, 2, 3};

struct Study {
  CaseSet cases = test::toy_cases(5);
  FieldData data = test::toy_field(cases);
  Study() = default;
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;
  [[nodiscard]] std::string key() const { return FieldRows(data, rows).key(); }
};

struct Change {
  const char* what;
  std::function<void(Study&)> make;
  bool whole, some;  ///< whose key is another
};

std::vector<Change> changes() {
  return {{"nothing", [](Study&) {}, false, false},
          {"a value", [](Study& s) { s.data.values(2, 7) += 1; }, true, true},
          {"a value of another case", [](Study& s) { s.data.values(1, 7) += 1; }, true, false},
          {"an input", [](Study& s) { s.cases.inputs(3, 2) += 1; }, true, true},
          {"a load", [](Study& s) { s.cases.loads[0] += 1; }, true, true},
          {"a name of a case", [](Study& s) { s.cases.names[0] = "x"; }, true, false},
          {"a cell's place", [](Study& s) { s.cases.mesh.centre(0, 0) += 1; }, true, false},
          {"how a mirror swaps", [](Study& s) { s.cases.mirrors[0].cell_from[0] += 1; }, true, false},
          {"the mirrors", [](Study& s) { s.cases.mirrors.pop_back(); }, true, false}};
}

TEST(CaseSet, KeysFollowWhatCanBeRead) {
  const Study before;
  for (const auto& change : changes()) {
    Study after;
    change.make(after);
    EXPECT_EQ(after.data.key() != before.data.key(), change.whole) << change.what;
    EXPECT_EQ(after.key() != before.key(), change.some) << change.what;
  }
}

TEST(CaseSet, KeysKnowAllThatTheCatalogueSaysOfAField) {
  Study study;
  const auto whole = study.data.key(), some = study.key();
  for (auto info : {FieldInfo{"other"}, FieldInfo{.unit = "Pa"}, FieldInfo{.parity = Parity::vector_x},
                    FieldInfo{.lower = 1}, FieldInfo{.upper = 1}}) {
    study.data.info = info;
    EXPECT_NE(study.data.key(), whole);
    EXPECT_NE(study.key(), some);
  }
}

TEST(CaseSet, RowsShowTheirCasesOnly) {
  const Study study;
  const FieldRows some(study.data, rows);

  ASSERT_EQ(some.n_cases(), 3U);
  EXPECT_EQ(some.load(1), study.cases.loads[2]);
  EXPECT_EQ(some.inputs(2)[4], study.cases.inputs(3, 4));
  EXPECT_EQ(some.values(2)[9], study.data.values(3, 9));
}

}  // namespace
}  // namespace elrom::field
