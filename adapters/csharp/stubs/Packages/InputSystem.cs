namespace UnityEngine.InputSystem
{
    public sealed class Mouse
    {
        public static Mouse current { get; set; }

        public Position position { get; } = new Position();

        public Button leftButton { get; } = new Button();
    }

    public sealed class Position
    {
        /// <summary>Not in Unity.</summary>
        public Vector2 Given { get; set; }

        public Vector2 ReadValue()
        {
            return Given;
        }
    }

    public sealed class Button
    {
        public bool isPressed { get; set; }
    }
}
