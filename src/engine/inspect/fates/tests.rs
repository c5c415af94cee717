use glam::{Mat4, Vec3};
use rayon::prelude::*;

use super::*;
use crate::chain::{SettingKey, run};
use crate::inspect::selection::TriangleSelection;
use crate::inspect::{FragmentOutcome, inspect};
use crate::internal::common::scenes;
use crate::internal::switches::{distinct, finishing_switches, single_switches, switches_of};
use crate::scene::{Camera, Library, Material, Mesh, MeshData, builtin};

const SIZE: Viewport = Viewport { width: 45, height: 31 };

/// Size of the pictures in which every pixel is replayed under every switch.
const SIZE_OF_MANY: Viewport = Viewport { width: 15, height: 11 };

/// Number of triangles above which a scene is drawn with one of [`RECIPE_STEP`] recipes.
const MANY_TRIANGLES: usize = 3_000;

/// Interval between the recipes that a scene of many triangles is drawn with. Scenes start at different ones.
const RECIPE_STEP: usize = 8;

/// Returns the recipes of all settings, and those of the visibility rules also without culling, so that more fragments cover
/// each pixel.
fn recipes() -> Vec<Recipe> {
    let without_culling = |mut recipe: Recipe| {
        recipe.pipeline.culling = Culling::None;
        recipe
    };
    let rules = [SettingKey::FillRule, SettingKey::DepthTest].into_iter().flat_map(switches_of).map(without_culling);
    distinct(single_switches().into_iter().chain(finishing_switches()).chain(rules))
}

/// Returns a camera close enough that many triangles are clipped and many lie behind it.
fn inside(scene: &Scene) -> Camera {
    let mut camera = scene.home;
    camera.dolly(0.15);
    camera
}

#[test]
fn every_sum_matches_in_every_scene_with_every_setting() {
    let scenes: Vec<_> = builtin::ALL.iter().map(builtin::Builtin::build).collect();
    let recipes = recipes();
    let of_scene = |(index, scene): (usize, &'_ Scene)| {
        let step = if scene.triangle_count() > MANY_TRIANGLES { RECIPE_STEP } else { 1 };
        recipes.iter().skip(index % step).step_by(step).map(move |recipe| (index, recipe)).collect::<Vec<_>>()
    };
    let cases: Vec<_> = scenes.iter().enumerate().flat_map(of_scene).collect();
    cases.par_iter().for_each(|(index, recipe)| {
        let scene = &scenes[*index];
        for camera in [scene.home, inside(scene)] {
            let frame = run(scene, &camera, recipe, SIZE, &mut ());
            let fates = Fates::of(scene, recipe, &frame);
            let reported = format!("{} {recipe:?}", scene.name);
            assert_eq!(fates.account.complaints(), [""; 0], "{reported}");
            assert_eq!(fates.triangle_counts().sum(), scene.triangle_count() as u64, "{reported}");
            assert_eq!(fates.triangle_counts().of(TriangleFate::Unaccounted), 0, "{reported}");
            let of_objects = |sum: fn(&ObjectFates) -> u64| fates.objects.iter().map(sum).sum::<u64>();
            assert_eq!(of_objects(|o| o.triangles.sum()), scene.triangle_count() as u64, "{reported}");
            assert_eq!(of_objects(|o| o.fragments.sum()), fates.fragment_counts().sum(), "{reported}");
            // Every sample that shows a triangle has exactly one visible fragment.
            let shown = fates.top_triangle.pixels().iter().filter(|id| **id != TriangleId::NONE).count() as u64;
            assert_eq!(fates.fragment_counts().of(FragmentFate::Visible), shown, "{reported}");
        }
    });
}

/// Counts the fragments of a frame by the outcomes that the replays of all pixels find. Every pixel must be drawn.
fn replayed_fragments(scene: &Scene, recipe: &Recipe, frame: &Frame) -> FragmentCounts<u64> {
    let mut counts = FragmentCounts::<u64>::default();
    let (width, height) = frame.image().size();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        for fragment in inspect(scene, recipe, frame, x, y).unwrap().fragments {
            let fate = match fragment.outcome {
                FragmentOutcome::Visible => FragmentFate::Visible,
                FragmentOutcome::Overwritten => FragmentFate::Overwritten,
                FragmentOutcome::BlendedOver => FragmentFate::BlendedOver,
                FragmentOutcome::DepthRejected => FragmentFate::LostDepth,
                FragmentOutcome::AlphaRejected => FragmentFate::AlphaRejected,
            };
            counts.0[fate as usize] += 1;
        }
    }
    counts
}

#[test]
fn fragment_fates_match_the_replays_of_all_pixels() {
    for id in ["stained-glass", "cubes", "near-plane", "interpenetrating"] {
        let scene = builtin::by_id(id).unwrap().build();
        let recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
        let expected = replayed_fragments(&scene, &recipe, &frame);
        assert_eq!(Fates::of(&scene, &recipe, &frame).fragment_counts(), expected, "{id}");
    }
}

#[test]
fn fragment_fates_match_the_replays_under_every_switch() {
    let recipes = single_switches();
    for (name, scene) in scenes() {
        recipes.par_iter().for_each(|recipe| {
            let frame = run(&scene, &scene.home, recipe, SIZE_OF_MANY, &mut ());
            let expected = replayed_fragments(&scene, recipe, &frame);
            assert_eq!(Fates::of(&scene, recipe, &frame).fragment_counts(), expected, "{name} {recipe:?}");
        });
    }
}

/// Builds a scene of single triangles in front of an orthographic camera that sees x and y from −1 to 1.
fn stage(objects: &[(&str, [Vec3; 3], f32)]) -> Scene {
    let mut library = Library::default();
    let instances = objects.iter().map(|(name, corners, opacity)| {
        let (positions, normals) = (corners.to_vec(), vec![Vec3::Z; 3]);
        let data = MeshData { positions, normals, triangles: vec![[0, 1, 2]], ..MeshData::default() };
        let mesh = library.add_mesh(Mesh::new(data).unwrap());
        let material = Material { opacity: *opacity, ..Material::plain("plain", Vec3::ONE) };
        let material = library.add_material(material);
        Instance { name: (*name).to_owned(), mesh, material, world_from_model: Mat4::IDENTITY, tint: Vec3::ONE }
    });
    let instances = instances.collect();
    let home = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO).with_orthographic(true);
    Scene {
        name: "stage".into(),
        library,
        instances,
        background: [0; 3],
        home,
        views: Vec::new(),
        light: None,
        animation: None,
    }
}

/// Returns the corners of a triangle around (x, y) with half width `half`, at distance `z` in front of the plane z = 0.
fn around(x: f32, y: f32, half: f32, z: f32) -> [Vec3; 3] {
    [[-half, -half], [half, -half], [0.0, half]].map(|[dx, dy]| Vec3::new(x + dx, y + dy, z))
}

#[test]
fn each_staged_triangle_has_the_expected_fate() {
    let back = |[a, b, c]: [Vec3; 3]| [a, c, b];
    let cast = [
        ("visible", around(0.0, 0.0, 0.5, 0.0), 1.0, TriangleFate::Visible),
        ("behind it", around(0.0, 0.0, 0.2, -1.0), 1.0, TriangleFate::LostDepth),
        ("turned", back(around(0.8, 0.0, 0.4, 0.0)), 1.0, TriangleFate::BackFacing),
        ("a line", [Vec3::ZERO, Vec3::X * 0.3, Vec3::X * 0.6], 1.0, TriangleFate::ZeroArea),
        ("far off", around(900.0, 0.0, 0.5, 0.0), 1.0, TriangleFate::Outside),
        ("behind the eye", around(0.0, 0.0, 0.5, 50.0), 1.0, TriangleFate::Outside),
        ("a speck", around(0.9, 0.9, 1e-3, 0.0), 1.0, TriangleFate::NoCentre),
        ("drawn first", around(-0.9, -0.6, 0.2, 0.0), 1.0, TriangleFate::Overwritten),
        ("drawn over it", around(-0.9, -0.6, 0.4, 1.0), 1.0, TriangleFate::Visible),
        ("under glass", around(-0.9, 0.8, 0.2, 0.0), 1.0, TriangleFate::BlendedOver),
        ("glass", around(-0.9, 0.8, 0.4, 1.0), 0.5, TriangleFate::Visible),
    ];
    let scene = stage(&cast.map(|(name, corners, opacity, _)| (name, corners, opacity)));
    let recipe = Recipe::default();
    let size = Viewport { width: 200, height: 160 };
    let frame = run(&scene, &scene.home, &recipe, size, &mut ());
    let fates = Fates::of(&scene, &recipe, &frame);
    let reported: Vec<_> = cast.iter().zip(&fates.triangles).map(|((name, ..), fate)| (*name, *fate)).collect();
    assert_eq!(reported, cast.map(|(name, _, _, fate)| (name, fate)));
    assert!(fates.account.is_balanced());

    // A visible triangle is shown at its representative pixel. Triangles outside the view or without area have no such
    // pixel.
    let places: Vec<_> = (0..cast.len() as u32).map(|id| fates.representative_pixel(TriangleId(id))).collect();
    for (id, (name, _, _, fate)) in cast.iter().enumerate() {
        match fate {
            TriangleFate::Outside | TriangleFate::ZeroArea => assert_eq!(places[id], None, "{name}"),
            TriangleFate::Visible => {
                let (x, y) = places[id].expect(name);
                let report = inspect(&scene, &recipe, &frame, x, y).unwrap();
                assert_eq!(report.visible().map(|f| f.triangle), Some(TriangleId(id as u32)), "{name}");
            }
            _ => assert!(places[id].is_some(), "{name}"),
        }
    }
    // Visibility of a visible triangle and of hidden triangles at their representative pixels.
    for (id, mark) in [
        (0, SelectionVisibility::Shown),
        (1, SelectionVisibility::Hidden),
        (2, SelectionVisibility::Hidden),
        (6, SelectionVisibility::Hidden),
    ] {
        let marks = fates.visibility_of(&TriangleSelection::new("one", [TriangleId(id)]));
        let (x, y) = places[id as usize].unwrap();
        assert_eq!(marks.at(x, y), mark, "{}", cast[id as usize].0);
    }
    // Filters by number, area and name.
    let found = |bin, text: &str| -> Vec<u32> {
        fates.members(bin, None, &FateFilter::parse(text)).iter().map(|id| id.0).collect()
    };
    assert_eq!(found(None, "tri 3"), [3]);
    assert_eq!(found(None, "#4"), [4]);
    assert_eq!(found(None, "area<1"), [6]);
    assert_eq!(found(None, "behind"), [1, 5]);
    assert_eq!(found(None, "PLAIN").len(), cast.len(), "all have a material of this name");
    assert_eq!(found(Some(Bin::Triangles(TriangleFate::Outside)), "the eye"), [5]);
    assert_eq!(found(Some(Bin::Fragments(FragmentFate::Overwritten)), ""), [7]);
    assert_eq!(fates.members(None, Some(8), &FateFilter::default()), [TriangleId(8)]);
}

#[test]
fn pieces_of_a_clipped_triangle_count_as_one_triangle() {
    let scene = builtin::by_id("near-plane").unwrap().build();
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
    let pieces = frame.geometry().triangles.len();
    let fates = Fates::of(&scene, &recipe, &frame);
    let rasterized = fates.triangles.iter().filter(|fate| **fate as usize >= TriangleFate::NoCentre as usize).count();
    assert!(rasterized < pieces, "{rasterized} triangles, {pieces} pieces: nothing was cut");
    let several = |id: &TriangleId| frame.geometry().triangles.iter().filter(|piece| piece.id == *id).count() > 1;
    let cut = fates.members(None, None, &FateFilter::parse("is:cut"));
    assert!((0..fates.triangles.len() as u32).map(TriangleId).filter(several).all(|id| cut.contains(&id)));
    assert!(!cut.is_empty() && cut.len() == fates.cut.len());
    assert!(fates.account.is_balanced());
}

#[test]
fn unbalanced_accounts_are_reported() {
    let scene = builtin::by_id("cubes").unwrap().build();
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
    let mut rejections = Rejections::new(scene.triangle_count());
    let mut geometry = prepare_again(&scene, &recipe, &frame, &mut rejections);
    let mut tally = FateTally::new(&scene, &recipe, &geometry, (SIZE.width, SIZE.height));
    assert!(Account::of(&geometry, &rejections, &tally).is_balanced());
    tally.generated = 1;
    let lost = geometry.triangles.last().unwrap().id;
    geometry.triangles.truncate(geometry.triangles.len() - 1);
    let again = geometry.triangles[0].id;
    rejections.fates[again.0 as usize] = Some(Fate::Outside);
    let account = Account::of(&geometry, &rejections, &tally);
    assert_eq!(
        (account.without_fate.as_slice(), account.with_two_fates.as_slice()),
        ([lost].as_slice(), [again].as_slice())
    );
    let complaints = account.complaints().join("; ");
    for words in
        ["1 triangles have no fate", "1 triangles have two fates", "1 fragments were generated, but 0 have a fate"]
    {
        assert!(complaints.contains(words), "{complaints}");
    }
}
