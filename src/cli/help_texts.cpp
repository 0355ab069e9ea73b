#include "cli/help_texts.h"

#include "patchlight/input/read_scene.h"
#include "patchlight/plan/plan.h"

#include "base/words.h"
#include "cli/parse_value.h"

#include <array>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

using enum Level;

constexpr std::string_view model = "Model", daylight = "Daylight", results = "Results", pictures = "Pictures",
                           sensors = "Sensors", patches = "Patches", accuracy = "Accuracy",
                           method = "Method and solver", effects = "Effects", sampling = "Cross-check", run = "Run";

// One entry for each option, or for each meaning that an option has in different commands.
constexpr OptionText options[] = {
    {"MODEL", "", model, common, "", "Model or scene files, together one scene; - is the standard input",
     "Formats: {formats}. A scene file (.toml) names models and adds lights, sensors and cameras."},
    {"FOLDER", "relight", model, common, "", "Folder that patchlight form-factors has written",
     "The folder holds the scene as well. The files of the model are not needed any more."},
    {"--solution", "render", results, common, "FILE", "Solution of this model (.vtp), from patchlight solve", ""},
    {"--format", "", model, usual, "{formats|}", "Format of the model files [default: by extension; obj for -]", ""},
    {"--unit", "", model, common, "m|cm|mm|in|ft", "Length of one model unit [default: set by the file, else m]",
     "Use it if `patchlight check` shows a wrong size, e.g. a room that is 4000 m long: `--unit mm`."},
    {"--up", "", model, usual, "y|z", "Vertical axis of the model [default: by format, else guessed, with a note]",
     "glTF files have y up; IFC, gbXML and Radiance files z. In other formats patchlight takes the axis across which "
     "most area lies, or the axis against which the lamps shine."},
    {"--set", "", model, common, "MATERIAL.QUANTITY=R,G,B",
     "Change a material, e.g. wall.reflectance=0.7 (repeatable) [default: as read]",
     "Quantities: reflectance (diffuse), specular_reflectance (of a mirror), transmittance (of clear glass), "
     "diffuse_transmittance (of a translucent sheet), each from 0 to 1; exitance (W/m^2); radiance (W/(m^2 sr)); index "
     "(of refraction, one value; 1 is a perforated sheet, the same at all angles). One value stands for all bands. In "
     "the name of the material, `*` and `?` stand for any letters: `--set 'lamp*.radiance=10'`."},
    {"--only", "", model, usual, "NAME", "Use only this object, group or material (repeatable) [default: all]",
     "`*` and `?` stand for any letters: `--only 'IfcWall*'`."},
    {"--exclude", "", model, usual, "NAME", "Leave out an object, group or material (repeatable) [default: none]",
     "`*` and `?` stand for any letters: `--exclude 'IfcFurnishing*'`."},
    {"--simplify", "", model, usual, "LENGTH", "Remove objects smaller than LENGTH (e.g. 5cm) [default: keep all]",
     "Objects that differ from a box by less than LENGTH become boxes. A note lists the changes."},
    {"--maintenance-factor", "", model, usual, "NUMBER", "Maintenance factor of lamps and luminaires [default: 1]",
     "The fraction of the light of new lamps that remains (EN 12464-1), e.g. 0.8 or 80%. Daylight does not change. "
     "Without this option, a scene file decides."},
    {"--bands", "", model, advanced, "N|rgb|auto", "Spectral bands, 380 to 780 nm [default: scene file, else auto]",
     "auto uses linear RGB if nothing has a spectrum, and otherwise as many bands as --color-error needs. A number "
     "gives bands of equal width."},
    {"--color-error", "", model, advanced, "DE", "Largest color error of the spectral bands, CIE dE00 [default: 1]",
     ""},
    {"--no-merge", "", model, advanced, "", "Keep the faces of the file [default: merge coplanar faces]",
     "By default, faces of one object and material that share edges and lie in one plane become one face. So a "
     "triangulated wall is meshed as one wall."},
    {"--confine", "", model, advanced, "FOLDER", "Read no file outside FOLDER [default: read any file]",
     "For models from unknown sources. Links that lead out of FOLDER are refused as well, and messages do not reveal "
     "whether a file outside exists."},

    {"--sky", "", daylight, common, "KIND[:STRENGTH]", "Sky: overcast, uniform, clear or perez, e.g. overcast:10000lx",
     "STRENGTH is the horizontal illuminance under the open sky; default 10000lx. A clear sky needs --sun. "
     "perez:DIRECT,DIFFUSE takes the measured direct normal and diffuse horizontal irradiance in W/m^2. Default: no "
     "sky, or the sky of the scene file."},
    {"--sun", "", daylight, common, "PLACE[:LX]", "Sun, e.g. 40,180:80000lx (altitude, azimuth) or TIME@LAT,LON",
     "The azimuth counts clockwise from north. LX is the direct normal illuminance. A sun by place and time: "
     "2024-06-21T12:00:00Z@52.5,13.4:80000lx. Without LX, the sun only shapes a clear sky. Default: no sun, or the sun "
     "of the scene file."},
    {"--ground", "", daylight, usual, "R", "Reflectance of the ground below the horizon, 0 to 1 [default: 0.2]", ""},
    {"--weather", "annual", daylight, common, "FILE.epw", "Weather of a year [default: that of the scene file]",
     "An EnergyPlus weather file with all 8760 hours. It replaces sun and sky of the scene file."},
    {"--hours", "annual", daylight, common, "FROM-TO", "Hours of each day that count, standard time [default: 8-18]",
     "8-18 is from 8:00 to 18:00, ten hours. The illuminance is computed for all hours of the year."},
    {"--sky-division", "annual", daylight, advanced, "1|2|4", "Parts of the sky: 1 is 145, 2 577, 4 2305 [default: 4]",
     "Tregenza's parts, cut once, twice or four times each way (Reinhart). The sun is not cut: each hour has its own."},
    {"--weather", "", daylight, usual, "FILE@HOUR", "Sun and sky of one hour of an EPW file: city.epw@6-21-12",
     "HOUR is MONTH-DAY-HOUR in standard time; the hour begins there. Default: no weather file, or that of the scene "
     "file."},

    {"-o,--output", "solve relight", results, common, "FILE",
     "Solved patches (.vtp, .vtu, .ply, .glb; repeatable) [default: none]",
     ".vtp is for ParaView and for patchlight render; .vtu for tools that read only unstructured grids. .ply and .glb "
     "have vertex colors for viewers and the web."},
    {"-o,--output", "annual", results, common, "FOLDER", "Folder for illuminances and tables of the year",
     "illuminance.npy and .ill have all hours and sensors; rooms.csv and sensors.csv the measures with errors. An "
     "earlier year in the folder is replaced."},
    {"-o,--output", "init", results, common, "SCENE.toml", "Scene file to create; it must not exist yet", ""},
    {"-o,--output", "form-factors", results, common, "FOLDER|FILE", "Folder to create, or one matrix file (.npy, .mtx)",
     "The folder holds the matrix, the areas, the patches and the scene. patchlight relight and patchlight solve "
     "--form-factors read it."},
    {"-o,--output", "compare-solvers", results, common, "FOLDER", "Folder for tables, plots and one series per solver",
     ""},
    {"-o,--output", "convergence", results, common, "FOLDER", "Folder for the table, the facts and the plots", ""},
    {"-o,--output", "render", results, common, "FILE", "Image (.png), or its radiances (.hdr, .exr)",
     "With several --view options, each image gets the name of its view before the extension: room.desk.png."},
    {"--html", "", results, common, "FILE", "Interactive page for any browser, one file (.html) [default: none]",
     "Rotate the model, click a patch to read its value and error bar, and read all tables. The page needs no other "
     "file and no network."},
    {"--json", "solve relight", results, common, "FILE",
     "Report of request, decisions, results (.json) [default: none]", ""},
    {"--json", "plan", results, common, "FILE", "Plan as JSON (.json) [default: text only]", ""},
    {"--json", "check selftest", results, common, "[FILE]", "Result as JSON, to FILE (.json) or to standard output",
     ""},
    {"--json", "crosscheck", results, common, "FILE", "Verdict and all patches compared (.json) [default: none]", ""},
    {"--series", "", results, advanced, "FILE", "Series of all iterations for ParaView (.pvd) [default: none]",
     "The default solver is then Jacobi: its iteration k adds the light of reflection k."},
    {"--lightmap", "", results, usual, "FOLDER", "Irradiance textures for real-time engines [default: none]",
     "Writes the irradiance as .exr and .png, the model with texture coordinates, and the model with the light as its "
     "colors (.glb)."},
    {"--texel", "", results, usual, "LENGTH", "Edge of the texels of the lightmap, e.g. 5cm [default: by map size]",
     "By default the smallest texel for a map of 256 x 256, or of more texels if there are many faces."},
    {"--all", "check", results, common, "", "List every object, material and problem [default: one screen]", ""},
    {"--problems", "check", results, common, "FILE", "Model with its bad faces marked, for ParaView (.vtp)",
     "The cell array problem_kind holds the kind of problem. Default: no file."},
    {"--matrix", "form-factors", results, usual, "npy|mtx", "Format of the matrix in the folder [default: npy]",
     "npy is NumPy's format; mtx is Matrix Market with coordinates."},
    {"--by", "form-factors", results, common, "material|object", "Table of form factors between groups of patches",
     "The table is printed and written into the folder as CSV. Default: patches only."},
    {"--difference", "render", results, common, "FILE", "Compare with another solution of this model (.vtp)",
     "The image shows both solutions and their difference of luminance in false colors. Default: one solution."},
    {"--observers", "render", results, usual, "FILE", "UGR and other values at the cameras (.csv) [default: none]",
     "Vertical and cylindrical illuminance, background luminance and UGR at the cameras of the scene file, or at those "
     "of --view or --camera. UGR has no error bar, and is that of the maintained luminaires."},
    {"--solvers", "compare-solvers", results, common, "A,B,...", "Solvers to compare, in this order [default: all]",
     "Any of {solvers}, and progressive-on-demand, which computes rows of form factors when it needs them."},
    {"--no-series", "compare-solvers", results, usual, "", "Write no series for ParaView [default: one per solver]",
     ""},
    {"--sizes", "convergence", results, common, "N", "Largest number of patch sizes [default: 4]",
     "Each size has half the edge of the previous one, so about four times the patches. The finest has --patches "
     "patches or edges of --max-edge."},
    {"--no-adaptive", "convergence", results, usual, "", "Skip the adaptive runs [default: 10, 3, 1 and 0.3 %]",
     "By default the model is also solved to these accuracies with local refinement, as far as --patches allows."},
    {"--no-estimators", "convergence", results, usual, "", "Skip the comparison of estimators [default: compare]",
     "The comparison uses a sixteenth of the patches."},

    {"--picture", "solve relight", pictures, common, "FILE", "Image (.png), or radiances (.hdr, .exr) [default: none]",
     ""},
    {"--picture", "check", pictures, common, "FILE", "Image of the model without light (.png, .hdr) [default: none]",
     "Shows the colors of the materials, darker where faces are close to each other."},
    {"--camera", "", pictures, usual, "EYE TARGET FOV", "View, e.g. 4,-3,1.6 0,0,1 60 [default: chosen by patchlight]",
     "EYE and TARGET are points X,Y,Z in model units. FOV is the vertical field of view in degrees."},
    {"--projection", "", pictures, usual, "NAME", "Projection of --camera [default: perspective]",
     "perspective, orthographic, angular, hemispherical (both fisheye) or panorama. For orthographic, FOV is the "
     "visible "
     "height in model units, and everything nearer than the plane of the eye is cut away."},
    {"--view", "render", pictures, common, "NAME", "Camera of the scene file (repeatable) [default: the first]", ""},
    {"--view", "", pictures, usual, "NAME", "Camera of the scene file [default: the first]", ""},
    {"--size", "", pictures, usual, "WIDTHxHEIGHT", "Size of the image in pixels [default: 800x800]", ""},
    {"--exposure", "render", pictures, usual, "VALUE|+STOPS|each", "Exposure [default: automatic, one for all views]",
     "VALUE is the factor from W/(m^2 sr) to display values, as the .png states it. +1 is one stop (twice) brighter "
     "than automatic, -1 one stop darker. All images of a run have the exposure of the first; with each, every image "
     "has its own."},
    {"--exposure", "", pictures, usual, "VALUE|+STOPS", "Exposure of the image [default: automatic]",
     "VALUE is the factor from W/(m^2 sr) to display values, as the .png states it. +1 is one stop (twice) brighter "
     "than automatic, -1 one stop darker."},
    {"--false-color", "", pictures, usual, "luminance[:END]", "False colors with a legend [default: natural]",
     "END is the end of the scale in cd/m^2, e.g. luminance:500. Default: a round number above 95 % of the lit pixels; "
     "all images of a run have the scale of the first."},
    {"--picture-quality", "render", pictures, usual, "draft|final", "Quality of the image [default: final]",
     "draft shows the smoothed solution. final computes the illumination of every visible point."},
    {"--picture-quality", "", pictures, usual, "draft|final", "Quality of the image [default: draft]",
     "draft shows the smoothed solution. final computes the illumination of every visible point."},
    {"--picture-error", "", pictures, advanced, "NUMBER", "Standard error of pixels of a final image [default: 1%]",
     "Relative to the luminance; dark pixels may have a larger error."},
    {"--picture-samples", "", pictures, advanced, "N", "Most samples per pixel, a power of two [default: 64]", ""},
    {"--picture-error-map", "", pictures, advanced, "FILE",
     "Error of each pixel in false colors (.png) [default: none]", ""},
    {"--ambient-occlusion", "check", pictures, advanced, "LENGTH", "Reach of the shading of --picture, e.g. 2m",
     "Default: a tenth of the mean extent of the model."},
    {"--ambient-occlusion", "", results, advanced, "LENGTH", "Add ambient occlusion to .vtp results [default: none]",
     "The array ambient_occlusion holds the fraction of the hemisphere of each patch in which nothing is nearer than "
     "LENGTH, e.g. 2m."},

    {"--points", "", sensors, usual, "FILE", "Points where irradiance is wanted, lines x y z nx ny nz [default: none]",
     "Positions are in model units (in meters for a scene file); nx ny nz is the direction of the receiving side."},
    {"--points-output", "", sensors, usual, "FILE", "Readings (.csv, .vtp) or maps (.svg, .png) (repeatable)",
     "Irradiance with error bars at the points and sensors. Default: NAME.irradiance.csv, beside the result or in the "
     "current folder."},
    {"--map", "", sensors, usual, "illuminance|daylight-factor", "Quantity of the maps [default: illuminance]",
     "Maps are .svg or .png files of --points-output, with isolines. Daylight factors need an overcast sky."},
    {"--map-range", "", sensors, usual, "LOWER,UPPER", "Color range of maps [default: 0 to a rounded maximum]", ""},

    {"--patches", "", patches, common, "N", "Approximate number of patches [default: {patches}]",
     "Met within about 10 %, and with error bars within 30 %, because these cut patches in four. Models with many "
     "faces "
     "need more. With --accuracy, the first mesh has {first_patches} patches by default."},
    {"--max-edge", "", patches, usual, "LENGTH", "Longest patch edge, e.g. 30cm [default: set by --patches]",
     "A number without a unit is in model units."},
    {"--sides", "check", patches, usual, "auto|front|both", "Count the simulated sides with this option [default: no]",
     ""},
    {"--sides", "", patches, usual, "auto|front|both", "Sides of the faces that are simulated [default: auto]",
     "auto leaves out the sides that no light can reach."},
    {"--no-contact-lines", "", patches, advanced, "", "Ignore contacts and shadow edges [default: follow them]",
     "By default, patches also end where other faces touch or cross a face and at the edges of hard shadows. No patch "
     "remains under an object that stands on a face."},
    {"--graded-edges", "", patches, advanced, "", "Use smaller patches along edges of faces [default: even sizes]",
     "On convex four-sided faces without contacts, patches shrink towards the edges where lit faces meet. Patches in "
     "the middle are longer, by up to 0.57 of the longest edge."},

    {"--accuracy", "", accuracy, common, "ERROR", "Refine until the estimated error is below, e.g. 2% [default: no]",
     "The relative error of the mean radiosity of the patches. patchlight refines the patches and the sampling where "
     "this reduces the error most."},
    {"--time-limit", "", accuracy, common, "TIME", "Refine for this time, e.g. 30s or 2min [default: no limit]",
     "The run ends earlier if --accuracy is reached. Sensors and images take additional time. Results with a time "
     "limit "
     "are not reproducible bit for bit."},
    {"--focus", "", accuracy, usual, "NAME", "Minimize the error of this object or material (repeatable)",
     "An object, group, material or room, or one side of it: room.inside. Default: with daylight .inside, all enclosed "
     "surfaces; otherwise all surfaces."},
    {"--no-refine", "", accuracy, usual, "", "Keep the first mesh [default: refine once if that pays]",
     "By default, a run of the ray method with an estimated error above 2 % is refined once if that removes at least a "
     "third of the error."},
    {"--error-bars", "", accuracy, usual, "", "Compute error bars for every patch [default: only if cheap]",
     "The errors of mesh, form factors and solver. The ray method always has them. The pair method has them by default "
     "up to 5,000 patches, if they take less than half of the run time."},
    {"--no-error-bars", "", accuracy, usual, "", "Skip error bars of the pair method [default: only if cheap]", ""},

    {"--method", "form-factors", method, usual, "pairs|rays", "Compute all pairs, or sample by rays [default: pairs]",
     "rays is for many patches, mirrors and glazing; each form factor has a standard error."},
    {"--method", "", method, common, "auto|pairs|rays|on-demand", "How form factors are computed [default: auto]",
     "pairs: all pairs of patches, most accurate. rays: sampled, for large models, mirrors and glazing. on-demand: "
     "computed whenever the solver needs them, least memory and an early first result, without closure. auto uses "
     "pairs; rays from 10,000 patches (from 1,000 if faces have few patches each), for mirrors and glazing and if "
     "memory "
     "is short; and pairs whenever another option needs them."},
    {"--rays", "", method, usual, "N", "Mean number of rays per patch; implies --method rays [default: 64]",
     "Four times as many rays halve their error. With --method auto the plan uses 256 rays for mirrors, glazing or "
     "faces with few patches."},
    {"--form-factors", "solve", method, usual, "FOLDER", "Use stored form factors of this model [default: compute]",
     "The folder comes from patchlight form-factors. Patches and sampling are those of the folder."},
    {"--checkpoint", "solve", method, usual, "FOLDER", "Continue a killed run from here [default: no checkpoint]",
     "Implies --method rays. The folder holds the form factors while the run lasts. Start the same command again to "
     "continue."},
    {"--no-closure", "", method, advanced, "", "Use form factors as computed [default: correct their row sums]",
     "Closure scales the rows so that sampling errors neither lose nor create light."},
    {"--solver", "", method, advanced, "{solvers|}", "Solver [default: cg; gmres with rays, jacobi with --series]", ""},
    {"--relaxation", "", method, advanced, "NUMBER", "Relaxation factor of sor, above 0, below 2 [default: estimated]",
     ""},
    {"--tolerance", "compare-solvers", method, usual, "NUMBER", "True relative error to reach [default: 1e-6]", ""},
    {"--tolerance", "convergence", method, usual, "NUMBER", "Smallest relative error of the solver [default: 1e-6]",
     ""},
    {"--tolerance", "", method, advanced, "NUMBER", "Relative error at which the solver stops [default: 1e-6]",
     "With --accuracy the default is as small as the accuracy needs; with the ray method 0.004 divided by the root of "
     "the number of rays."},
    {"--max-iterations", "compare-solvers", method, usual, "N", "Limit of iterations [default: 10000]",
     "progressive-on-demand stops after as many steps as there are patches."},
    {"--max-iterations", "", method, advanced, "N", "Limit of iterations of the solver [default: 1000]", ""},
    {"--max-rows", "", method, advanced, "PERCENT", "Stop after this part of the rows, e.g. 5% [default: no limit]",
     "For a first image: the solvers progressive and overshooting stop after this fraction of the rows of form "
     "factors."},
    {"--samples", "", method, advanced, "N", "Shadow rays of a partly occluded pair of patches [default: 8]", ""},
    {"--estimator", "", method, advanced, "auto|area|point-polygon|hemisphere|contour",
     "Estimator of form factors, to compare methods [default: auto]",
     "auto takes most rays per pair, and needs the least time for a given error. area: points on both patches. "
     "point-polygon: points on one patch and the exact factor to the other. hemisphere: "
     "--samples rays over the hemisphere of each patch. contour: the contour integral times the visible fraction."},
    {"--without", "form-factors", method, advanced, "hidden|free|far",
     "Switch a shortcut off, to measure its effect (repeatable) [default: all on]",
     "hidden: clusters of patches that cannot see each other need no rays. free: nor do clusters with nothing between "
     "them. far: distant pairs use a coarse rule."},
    {"--seed", "", method, advanced, "N", "Seed of the sampling; the same seed gives the same bits [default: 1]", ""},

    {"--enable", "form-factors", effects, advanced, "EFFECT", "Simulate an effect: reach or backs [default: planned]",
     "Overrides a decision of the plan. Repeatable."},
    {"--disable", "form-factors", effects, advanced, "EFFECT", "Leave out an effect: reach or backs [default: planned]",
     "Overrides a decision of the plan. Repeatable."},
    {"--enable", "", effects, usual, "EFFECT", "Simulate this effect in any case (repeatable) [default: planned]",
     "Effects: {effects}. `patchlight plan` lists the decisions and their reasons. patchlight relight takes only the "
     "effects that do not change form factors."},
    {"--disable", "", effects, usual, "EFFECT", "Leave this effect out (repeatable) [default: planned]",
     "The effects of --enable."},

    {"--paths", "crosscheck", sampling, common, "N", "Paths per patch and sensor [default: 4096]",
     "Rounded up to 32 times a power of two. The noise of the check falls with the root of N."},
    {"--sample-patches", "crosscheck", sampling, common, "N", "Most patches, sensors, rooms to check [default: 64]",
     "Seven eighths of the patches are inside, or belong to --focus."},
    {"--margin", "crosscheck", sampling, usual, "PERCENT", "Accept this standard error, e.g. 2% [default: error bars]",
     "Each irradiance may differ by so much of its value, or of the mean if that is larger, instead of by its error "
     "bar."},

    {"--threads", "", run, usual, "N", "Number of threads; 0: one per processor [default: 0]", ""},
    {"--memory", "", run, usual, "SIZE", "Memory limit, e.g. 2GB or 500MiB [default: 80 % of the machine's]",
     "patchlight refuses a run that needs more before the run starts."},
    {"--discard", "", run, usual, "", "Write no results if interrupted [default: write the results so far]", ""},
    {"-q,--quiet", "", run, common, "", "Print errors and warnings only [default: progress and a summary]",
     "patchlight crosscheck prints the verdict unless it agrees."},
    {"-v,--verbose", "", run, usual, "", "Add decisions, counts and speed to the summary [default: off]", ""},
    {"-h,--help", "", run, usual, "", "Print help: -h the common options, --help all", ""},
};

constexpr std::string_view start = "Start", understand = "Understand", variants = "Variants", research = "Research",
                           maintenance = "Maintenance";

constexpr CommandText commands[] = {
    {"check", start, "Report the contents of a model and its problems", "MODEL... [OPTIONS]",
     "Reads a model and reports its size, faces, materials, lights, rooms and glazing, the problems of its geometry, "
     "and "
     "the command to run next. It solves nothing.",
     "# contents and problems on one screen\npatchlight check room.obj\n"
     "# every problem, and the faces for ParaView\npatchlight check house.ifc --all --problems problems.vtp\n"
     "# an image of the model without light\npatchlight check house.ifc --picture house.png\n"},
    {"init", start, "Create a commented scene file for a model", "MODEL... -o SCENE.toml [OPTIONS]",
     "Writes a scene file (TOML) for a model and adds missing parts: a sky (or a lamp, if the model has no windows), "
     "the "
     "glazing, and a sensor grid and a camera in each room. Edit the file, then solve it.",
     "# a scene with daylight and sensors\npatchlight init house.ifc -o house.toml\n"
     "# a model in millimeters\npatchlight init room.obj --unit mm -o room.toml\n"
     "# several files form one scene\npatchlight init walls.obj desks.obj -o office.toml\n"},
    {"solve", start, "Compute the light on all surfaces of a model", "MODEL... -o RESULT.vtp [OPTIONS]",
     "Divides the surfaces into patches, computes the form factors between them and solves for the light that the "
     "patches exchange. Every value has an error bar. At least one output is needed: -o, --html, --picture, --json, "
     "--points, --series or --lightmap.",
     "# patches for ParaView, and a page for the browser\npatchlight solve room.obj -o room.vtp --html room.html\n"
     "# refine until the estimated error is below 2 %\npatchlight solve office.toml -o office.vtp --accuracy 2%\n"
     "# a building under an overcast sky\npatchlight solve house.ifc --sky overcast:10000lx --picture house.png\n"},
    {"render", start, "Render images of a saved solution", "MODEL... --solution RESULT.vtp -o VIEW.png [OPTIONS]",
     "Renders images, lightmaps and glare values of a solution without solving again. Give the same model and the same "
     "model options as for the solution.",
     "# one image\npatchlight render room.obj --solution room.vtp -o room.png\n"
     "# a view of the scene file, larger\npatchlight render office.toml --solution office.vtp --view desk --size "
     "1600x900 -o desk.png\n"
     "# how two solutions differ\npatchlight render room.obj --solution a.vtp --difference b.vtp -o difference.png\n"},
    {"annual", start, "Compute a year of daylight at the sensors", "MODEL... -o FOLDER [OPTIONS]",
     "Computes the illuminance at all sensors in each hour of a year, and daylight autonomy, sDA, ASE, UDI and the "
     "levels of EN 17037 for each sensor and room. Sun and sky come from a weather file. Electric light is left out.",
     "# a year of a building with sensors in its rooms\npatchlight annual office.toml --weather city.epw -o year\n"
     "# for an office that is used from 7 to 17\npatchlight annual office.toml --weather city.epw --hours 7-17 -o "
     "year\n"
     "# with white walls\npatchlight annual office.toml --weather city.epw --set wall.reflectance=0.8 -o year\n"},
    {"plan", understand, "Dry run: list the simulated effects and the expected cost", "MODEL... [OPTIONS]",
     "A dry run. Lists the effects that a run will simulate and why, and estimates patches, memory and time. It takes "
     "the options of patchlight solve that change these.",
     "# decisions and costs\npatchlight plan room.obj\n"
     "# the cost of more patches\npatchlight plan house.ifc --sky overcast --patches 100000\n"
     "# for a script\npatchlight plan room.obj --json plan.json\n"},
    {"crosscheck", understand, "Check a solution with an independent path tracer", "MODEL... [OPTIONS]",
     "Solves the model, traces paths to some patches, sensors and rooms, and compares both. The exit status is 5 if "
     "they "
     "disagree.",
     "# agreement within the error bars\npatchlight crosscheck room.obj\n"
     "# a sharper check of more patches\npatchlight crosscheck room.obj --sample-patches 200 --paths 16384\n"
     "# accept deviations of 2 %\npatchlight crosscheck room.obj --margin 2%\n"},
    {"relight", variants, "Solve again with other materials or lights", "FOLDER -o RESULT.vtp [OPTIONS]",
     "Uses stored form factors, so that only the equations are solved again. Materials, lamps, sun and sky may change; "
     "the geometry may not.",
     "# once\npatchlight form-factors room.obj -o room.ff\n"
     "# another lamp\npatchlight relight room.ff --set lamp.radiance=20 -o bright.vtp\n"
     "# lighter walls\npatchlight relight room.ff --set wall.reflectance=0.8 --html light.html\n"},
    {"form-factors", research, "Compute the form factors between patches", "MODEL... -o FOLDER [OPTIONS]",
     "Writes the form factors as a folder for patchlight relight, or as one matrix for NumPy or Matrix Market.",
     "# a folder for patchlight relight\npatchlight form-factors room.obj -o room.ff\n"
     "# the matrix alone, without closure\npatchlight form-factors room.obj --no-closure -o F.npy\n"
     "# a table between materials\npatchlight form-factors room.obj --by material -o room.ff\n"},
    {"compare-solvers", research, "Compare the convergence of all solvers", "MODEL... -o FOLDER [OPTIONS]",
     "Solves the same equations with every solver and writes tables, plots and a series for ParaView per solver.",
     "# all solvers\npatchlight compare-solvers room.obj -o compared\n"
     "# three of them\npatchlight compare-solvers room.obj --solvers cg,jacobi,gmres -o compared\n"
     "# a page for the browser\npatchlight compare-solvers room.obj -o compared --html compared.html\n"},
    {"convergence", research, "Measure the cost of accuracy for a model", "MODEL... -o FOLDER [OPTIONS]",
     "Solves a model with several patch sizes, accuracies and estimators, and writes the error and time of each run.",
     "# errors and times\npatchlight convergence room.obj -o study\n"
     "# up to 16,000 patches\npatchlight convergence room.obj --patches 16000 -o study\n"
     "# uniform meshes only\npatchlight convergence room.obj --no-adaptive --no-estimators -o study\n"},
    {"selftest", maintenance, "Test this installation against closed-form solutions", "[OPTIONS]",
     "Solves cases with known answers. The exit status is 5 if one of them fails.",
     "# a table of all cases\npatchlight selftest\n# for a script\npatchlight selftest --json selftest.json\n"
     "# on one processor\npatchlight selftest --threads 1\n"},
};

// The words of a list that a text contains.
bool contains_word(std::string_view words, std::string_view word) {
  for (std::size_t at = words.find(word); at != words.npos; at = words.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || words[at - 1] == ' ') && (end == words.size() || words[end] == ' ')) return true;
  }
  return false;
}

}  // namespace

std::span<const CommandText> command_texts() { return commands; }

std::span<const OptionText> option_texts() { return options; }

const OptionText& option_text(std::string_view command, std::string_view name) {
  const OptionText* general = nullptr;
  for (const OptionText& text : options) {
    if (text.names != name) continue;
    if (contains_word(text.commands, command)) return text;
    if (text.commands.empty()) general = &text;
  }
  if (general == nullptr) throw std::logic_error("no text for " + std::string(command) + ' ' + std::string(name));
  return *general;
}

std::string filled_in(std::string_view text) {
  std::vector<std::string> effects;
  for (const Effect effect : simulated_effects())
    if (effect != Effect::closure) effects.emplace_back(name_of(effect));
  const std::array<std::pair<std::string, std::string>, 7> lists = {
      {{"{formats}", listed(readable_formats())},
       {"{formats|}", listed(readable_formats(), "|")},
       {"{solvers}", solver_names(", ")},
       {"{solvers|}", solver_names("|")},
       {"{effects}", listed(effects)},
       {"{patches}", std::to_string(default_patches)},
       {"{first_patches}", std::to_string(first_patches)}}};
  std::string result(text);
  for (const auto& [name, list] : lists) {
    const std::size_t at = result.find(name);
    if (at != std::string::npos) result.replace(at, name.size(), list);
  }
  return result;
}

}  // namespace patchlight::cli
