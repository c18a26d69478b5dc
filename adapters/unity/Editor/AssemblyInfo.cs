using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("Pacinian.Haptics.Editor.Tests")]
