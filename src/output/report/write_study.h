#pragma once

#include "patchlight/output/provenance.h"

#include "study/study.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace patchlight {

/// The content of study.json. Names from a model may hold bytes that are not UTF-8.
nlohmann::ordered_json study_json(const Scene& scene, const Study& study, const Provenance& provenance);

/// Writes a folder, whole or not at all: a row per setting (study.csv), the same with the reference, the prices and the
/// conclusion (study.json), and plots (.svg and .png) of the error against CPU seconds and against the memory of the
/// form factors, with the Pareto front, and of what estimators of form factors err by themselves.
/// docs/reference/outputs/studies.md describes them. \throws OutputError.
void write_study(const std::filesystem::path& folder, const Scene& scene, const Study& study,
                 const Provenance& provenance);

/// Fails early: \throws OutputError when write_study could not write here.
void check_study_writable(const std::filesystem::path& folder);

}  // namespace patchlight
