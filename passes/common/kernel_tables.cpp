#include "passes/common/kernel_tables.hpp"

#include <algorithm>

namespace dermis::subsurface {
namespace {

// Tables of a list of profiles, in order and equally long for all that have any.
template <class Row> struct KnownTables {
  std::vector<const NumberedProfile*> profiles;
  std::span<const Row> rows;

  // Returns the table of a profile with the same shape; empty if there is none.
  std::span<const Row> find(const NumberedProfile& numbered) const {
    const auto same = [&](const NumberedProfile* one) {
      return one->profile.model == numbered.profile.model &&
             one->profile.shape_mm == numbered.profile.shape_mm;
    };
    const auto found = std::find_if(profiles.begin(), profiles.end(), same);
    if (found == profiles.end()) return {};
    const size_t length = rows.size() / profiles.size();
    return rows.subspan(static_cast<size_t>(found - profiles.begin()) * length, length);
  }
};

// Appends the known table of a profile, or the one that make() returns.
template <class Row, class Make>
void append(std::vector<Row>& all, const KnownTables<Row>& known, const NumberedProfile& numbered,
            const Make& make) {
  if (const auto table = known.find(numbered); !table.empty()) {
    all.insert(all.end(), table.begin(), table.end());
  } else {
    const std::vector<Row> made = make();
    all.insert(all.end(), made.begin(), made.end());
  }
}

void add_separable(KernelTables& tables, const KernelTables* before) {
  KnownTables<SeparableRow> known;
  if (before != nullptr && before->use.separable && !before->fitted.empty()) {
    known.rows = before->separable;
    for (const NumberedProfile& numbered : before->fitted)
      known.profiles.push_back(&numbered);
  }
  if (tables.use.separable)
    for (const NumberedProfile& numbered : tables.fitted)
      append(tables.separable, known, numbered, [&] { return make_separable_table(numbered); });
  if (tables.separable.empty()) tables.separable.emplace_back();
}

void add_pyramid(KernelTables& tables, const KernelTables* before) {
  const PyramidUse& use = tables.use.pyramid;
  KnownTables<float> known;
  if (before != nullptr && before->use.pyramid == use) {
    const auto shared =
        before->pyramid.begin() + static_cast<std::ptrdiff_t>(before->shared_floats);
    tables.pyramid.assign(before->pyramid.begin(), shared);
    known.rows = {shared, before->pyramid.end()};
    for (const NumberedProfile& numbered : before->fitted)
      if (has_own_tables(numbered)) known.profiles.push_back(&numbered);
  } else {
    tables.pyramid = make_shared_sap_tables(use);
  }
  tables.shared_floats = tables.pyramid.size();
  for (const NumberedProfile& numbered : tables.fitted)
    append(tables.pyramid, known, numbered, [&] { return make_own_sap_tables(use, numbered); });
}

} // namespace

TableUse table_use(const Graph& graph, const PassTypeRegistry& pass_types) {
  return {uses_separable(graph, pass_types), pyramid_use(graph, pass_types)};
}

KernelTables make_kernel_tables(const TableUse& use, std::span<const NumberedProfile> profiles,
                                const KernelTables* before) {
  KernelTables tables;
  tables.use = use;
  tables.fitted.assign(profiles.begin(), profiles.end());
  tables.profiles = make_profile_table(profiles, use.separable, use.pyramid.pixel_grid);
  tables.radial = make_radial_table(profiles);
  add_separable(tables, before);
  add_pyramid(tables, before);
  return tables;
}

} // namespace dermis::subsurface
