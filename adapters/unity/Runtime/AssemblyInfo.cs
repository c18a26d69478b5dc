using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("Pacinian.Haptics.Editor")]
[assembly: InternalsVisibleTo("Pacinian.Haptics.Tests")]
[assembly: InternalsVisibleTo("Pacinian.Haptics.Ultraleap")]
[assembly: InternalsVisibleTo("Pacinian.Haptics.Editor.Tests")]
